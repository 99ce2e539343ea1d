/* Whether the names of people who are taken over go together. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/gallery/gallery_state.h"

static const struct iso_person *find_exactly(const struct iso_gallery *gallery, const char *name)
{
    const struct iso_person *person = iso_gallery_find(gallery, name);
    return person && strcmp(person->name, name) == 0 ? person : NULL;
}

/* A name that comes, with its key. */
struct coming {
    const char *name;
    struct iso_person_name_key key;
};

static int by_key(const void *a, const void *b)
{
    const struct coming *one = a, *other = b;
    const int order = memcmp(&one->key, &other->key, sizeof one->key);
    return order ? order : strcmp(one->name, other->name);
}

/* Two spellings of one name may come only to replace two people who are here under just these: a
 * gallery of before may hold both. */
static int check_pair(const struct iso_gallery *gallery, const struct coming *one,
                      const struct coming *other, struct iso_fault *fault)
{
    if (!iso_person_name_key_is_same(&one->key, &other->key)) {
        return 0;
    }
    if (strcmp(one->name, other->name) == 0) {
        return iso_fault_set(fault, -EINVAL, "%s comes twice", one->name);
    }
    return find_exactly(gallery, one->name) && find_exactly(gallery, other->name)
               ? 0
               : iso_fault_set(fault, -EINVAL, "%.80s and %.80s are one name: rename one of them",
                               one->name, other->name);
}

int iso__gallery_check_names(const struct iso_gallery *gallery,
                             const struct iso_gallery_item *items, size_t n,
                             struct iso_fault *fault)
{
    int error = 0;
    struct coming *coming = calloc(n ? n : 1, sizeof *coming);
    for (size_t i = 0; coming && !error && i < n; i++) {
        coming[i].name = items[i].person.name;
        error = iso_person_name_key(coming[i].name, &coming[i].key);
    }
    if (!coming || error) {
        free(coming);
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    qsort(coming, n, sizeof *coming, by_key);
    for (size_t i = 1; !error && i < n; i++) {
        error = check_pair(gallery, &coming[i - 1], &coming[i], fault);
    }
    free(coming);
    return error;
}
