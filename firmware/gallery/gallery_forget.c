/* Deletes the learned templates: the gallery then contains only what was enrolled. */
#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/gallery/gallery_state.h"

/* A person without learned templates, with the bytes to which the item points. */
struct restored {
    struct iso_gallery_item item;
    uint8_t bytes[ISO_GALLERY_TEMPLATES_MAX][ISO_TEMPLATE_BYTES_MAX];
};

struct restoring {
    struct restored *people;
    size_t n, capacity, n_learned;
};

/* A template that this version cannot read was not learned by this version. */
static bool is_learned(const void *bytes, size_t size)
{
    struct iso_template_facts facts;
    return iso_template_check(bytes, size, &facts) == 0 && facts.learned;
}

static void wipe(struct restoring *restoring)
{
    if (restoring->people) {
        sodium_memzero(restoring->people, restoring->capacity * sizeof *restoring->people);
        free(restoring->people);
    }
}

/* Makes room for one more person. If the array moves, its old memory is wiped. */
static int reserve(struct restoring *restoring)
{
    if (restoring->n < restoring->capacity) {
        return 0;
    }
    const size_t more = restoring->capacity ? 2 * restoring->capacity : 1;
    struct restored *people = calloc(more, sizeof *people);
    if (!people) {
        return -ENOMEM;
    }
    for (size_t i = 0; i < restoring->n; i++) {
        people[i] = restoring->people[i];
        for (size_t t = 0; t < people[i].item.n; t++) {
            people[i].item.templates[t].bytes = people[i].bytes[t];
        }
    }
    wipe(restoring);
    restoring->people = people;
    restoring->capacity = more;
    return 0;
}

static int restore(void *context, const struct iso_gallery_item *item, struct iso_fault *fault)
{
    struct restoring *restoring = context;
    size_t learned = 0;
    for (size_t i = 0; i < item->n; i++) {
        learned += is_learned(item->templates[i].bytes, item->templates[i].size);
    }
    if (learned == 0 || learned == item->n) {
        return 0;
    }
    if (reserve(restoring)) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    struct restored *person = &restoring->people[restoring->n++];
    person->item.person = item->person;
    for (size_t i = 0; i < item->n; i++) {
        const size_t size = item->templates[i].size;
        if (!is_learned(item->templates[i].bytes, size)) {
            const size_t to = person->item.n++;
            memcpy(person->bytes[to], item->templates[i].bytes, size);
            person->item.templates[to].algorithm = item->templates[i].algorithm;
            person->item.templates[to].bytes = person->bytes[to];
            person->item.templates[to].size = size;
            person->item.templates[to].excluded = item->templates[i].excluded;
        }
    }
    restoring->n_learned += learned;
    return 0;
}

/* Puts the items into one array, as an import expects them. */
static int import(struct iso_gallery *gallery, const struct restoring *restoring,
                  struct iso_fault *fault)
{
    size_t added = 0;
    struct iso_gallery_item *items = calloc(restoring->n, sizeof *items);
    if (!items) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    for (size_t i = 0; i < restoring->n; i++) {
        items[i] = restoring->people[i].item;
    }
    gallery->renumbers = true;
    const int error = iso_gallery_import(gallery, items, restoring->n, true, NULL, &added, fault);
    gallery->renumbers = false;
    sodium_memzero(items, restoring->n * sizeof *items);
    free(items);
    return error;
}

int iso_gallery_forget_learned(struct iso_gallery *gallery, size_t *n, struct iso_fault *fault)
{
    struct restoring restoring = {0};
    if (!gallery->memory.may_be_learned && !iso__gallery_is_lost(gallery)) {
        *n = 0; /* templates are not read again for this */
        return 0;
    }
    int error = iso_gallery_export(gallery, NULL, restore, &restoring, fault);
    if (!error && restoring.n > 0) {
        error = import(gallery, &restoring, fault);
    }
    if (!error) {
        *n = restoring.n_learned;
    }
    wipe(&restoring);
    return error;
}
