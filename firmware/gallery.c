#include "firmware/gallery.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/gallery_db.h"

struct iso_gallery {
    struct iso_gallery_db *db;
    size_t capacity;
    uint32_t algorithm;

    struct iso_person *people; /* by rising id */
    size_t n_people, people_capacity;
    struct iso_search_entry *entries; /* in the order of people */
    size_t n_entries, entries_capacity;
};

/* ---- memory ---- */

static void free_template(const struct iso_template *tmpl)
{
    struct iso_template *own = (struct iso_template *)(uintptr_t)tmpl;
    if (own) {
        iso_template_wipe(own);
        free(own);
    }
}

/* Room for one more item of an array. */
static int reserve(void **items, size_t item_size, size_t n, size_t *capacity)
{
    if (n < *capacity) {
        return 0;
    }
    const size_t more = *capacity ? 2 * *capacity : 16;
    void *grown = reallocarray(*items, more, item_size);
    if (!grown) {
        return -ENOMEM;
    }
    *items = grown;
    *capacity = more;
    return 0;
}

static int reserve_person(struct iso_gallery *gallery)
{
    void *people = gallery->people;
    const int error = reserve(&people, sizeof *gallery->people, gallery->n_people,
                              &gallery->people_capacity);
    gallery->people = people;
    return error;
}

static int reserve_entry(struct iso_gallery *gallery)
{
    void *entries = gallery->entries;
    const int error = reserve(&entries, sizeof *gallery->entries, gallery->n_entries,
                              &gallery->entries_capacity);
    gallery->entries = entries;
    return error;
}

/* Behind the last entry of this person or of one enrolled before. There is room. */
static void insert_entry(struct iso_gallery *gallery, int64_t person,
                         const struct iso_template *tmpl)
{
    size_t at = gallery->n_entries;
    while (at > 0 && gallery->entries[at - 1].person > person) {
        at--;
    }
    memmove(gallery->entries + at + 1, gallery->entries + at,
            (gallery->n_entries - at) * sizeof *gallery->entries);
    gallery->entries[at] = (struct iso_search_entry){.person = person, .tmpl = tmpl};
    gallery->n_entries++;
}

static void remove_entries(struct iso_gallery *gallery, int64_t person)
{
    size_t kept = 0;
    for (size_t i = 0; i < gallery->n_entries; i++) {
        if (gallery->entries[i].person == person) {
            free_template(gallery->entries[i].tmpl);
        } else {
            gallery->entries[kept++] = gallery->entries[i];
        }
    }
    gallery->n_entries = kept;
}

static struct iso_person *find_own(const struct iso_gallery *gallery, int64_t id)
{
    for (size_t i = 0; i < gallery->n_people; i++) {
        if (gallery->people[i].id == id) {
            return &gallery->people[i];
        }
    }
    return NULL;
}

/* ---- opening ---- */

static int load_person(void *context, const struct iso_person *person, struct iso_fault *fault)
{
    struct iso_gallery *gallery = context;
    if (reserve_person(gallery)) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    gallery->people[gallery->n_people++] = *person;
    return 0;
}

/* Takes a template in that the running algorithm can use. */
static int load_usable(struct iso_gallery *gallery, struct iso_person *person,
                       const struct iso_template *tmpl, struct iso_fault *fault)
{
    struct iso_template *copy = malloc(sizeof *copy);
    if (!copy || reserve_entry(gallery)) {
        free(copy);
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    *copy = *tmpl;
    insert_entry(gallery, person->id, copy);
    person->usable++; /* NOLINT(clang-analyzer-unix.Malloc): the gallery's entry keeps the copy */
    return 0;
}

static int load_template(void *context, int64_t person_id, uint32_t algorithm, const void *bytes,
                         size_t size, struct iso_fault *fault)
{
    struct iso_gallery *gallery = context;
    struct iso_person *person = find_own(gallery, person_id);
    struct iso_template tmpl;
    if (!person) {
        return iso_gallery_db_damaged(gallery->db, "a template belongs to nobody", fault);
    }
    person->templates++;
    int error = iso_template_parse(bytes, size, &tmpl);
    if (error == -EPROTONOSUPPORT) {
        return 0;
    }
    if (error || tmpl.algorithm != algorithm) {
        return iso_gallery_db_damaged(gallery->db, "a template cannot be read", fault);
    }
    if (algorithm == gallery->algorithm) {
        error = load_usable(gallery, person, &tmpl, fault);
    }
    iso_template_wipe(&tmpl);
    return error;
}

int iso_gallery_open(const char *path, int capacity, uint32_t algorithm, struct iso_gallery **out,
                     struct iso_fault *fault)
{
    struct iso_gallery *gallery = calloc(1, sizeof *gallery);
    if (!gallery) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    gallery->capacity = (size_t)capacity;
    gallery->algorithm = algorithm;
    int error = iso_gallery_db_open(path, &gallery->db, fault);
    if (!error) {
        const struct iso_gallery_visitor visitor = {load_person, load_template, gallery};
        error = iso_gallery_db_load(gallery->db, &visitor, fault);
    }
    if (error) {
        iso_gallery_close(gallery);
        return error;
    }
    *out = gallery;
    return 0;
}

void iso_gallery_close(struct iso_gallery *gallery)
{
    if (gallery) {
        for (size_t i = 0; i < gallery->n_entries; i++) {
            free_template(gallery->entries[i].tmpl);
        }
        free(gallery->entries);
        free(gallery->people);
        iso_gallery_db_close(gallery->db);
        free(gallery);
    }
}

/* ---- changing ---- */

int iso_gallery_room(const struct iso_gallery *gallery, const char *name, struct iso_fault *fault)
{
    const struct iso_person *person = iso_gallery_find(gallery, name);
    if (!person && gallery->n_people >= gallery->capacity) {
        return iso_fault_set(fault, -EDQUOT, "the gallery is full: %zu people", gallery->n_people);
    }
    if (person && person->templates >= ISO_GALLERY_TEMPLATES_MAX) {
        return iso_fault_set(fault, -EDQUOT, "%s has %u templates, there is no room for more", name,
                             person->templates);
    }
    return 0;
}

/* The transaction, and then the memory for which there is room: nothing can go wrong between. */
static int add_reserved(struct iso_gallery *gallery, const struct iso_person *person,
                        const struct iso_template *copy, const void *bytes, size_t size,
                        struct iso_fault *fault)
{
    const struct iso_person *known = iso_gallery_find(gallery, person->name);
    struct iso_person row = *person;
    row.id = known ? known->id : 0;
    const int error = iso_gallery_db_add(gallery->db, &row, copy->algorithm, bytes, size, &row.id,
                                         fault);
    if (error) {
        return error;
    }
    if (!known) {
        row.templates = row.usable = 0;
        gallery->people[gallery->n_people++] = row;
    }
    struct iso_person *own = find_own(gallery, row.id);
    own->valid_from_s = row.valid_from_s;
    own->valid_until_s = row.valid_until_s;
    own->templates++;
    own->usable++;
    insert_entry(gallery, row.id, copy);
    return 0;
}

static int check_addition(const struct iso_gallery *gallery, const struct iso_person *person,
                          const struct iso_template *tmpl, struct iso_fault *fault)
{
    const char *flaw = iso_person_name_flaw(person->name);
    if (flaw) {
        return iso_fault_set(fault, -EINVAL, "%s", flaw);
    }
    if (tmpl->algorithm != gallery->algorithm) {
        return iso_fault_set(fault, -EINVAL, "the template is of another algorithm");
    }
    return iso_gallery_room(gallery, person->name, fault);
}

int iso_gallery_add(struct iso_gallery *gallery, const struct iso_person *person,
                    const struct iso_template *tmpl, struct iso_fault *fault)
{
    uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    int error = check_addition(gallery, person, tmpl, fault);
    if (error) {
        return error;
    }
    const int size = iso_template_serialise(tmpl, bytes, sizeof bytes);
    if (size < 0) {
        return iso_fault_set(fault, -EINVAL, "the template is out of range");
    }
    struct iso_template *copy = malloc(sizeof *copy);
    if (!copy || reserve_person(gallery) || reserve_entry(gallery)) {
        error = iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    } else {
        /* As it will be read back: the search sees the same before and after a restart. */
        error = iso_template_parse(bytes, (size_t)size, copy);
    }
    if (!error) {
        error = add_reserved(gallery, person, copy, bytes, (size_t)size, fault);
    }
    if (error) {
        free_template(copy);
    }
    explicit_bzero(bytes, sizeof bytes);
    return error;
}

int iso_gallery_remove(struct iso_gallery *gallery, const char *name, struct iso_fault *fault)
{
    const struct iso_person *person = iso_gallery_find(gallery, name);
    if (!person) {
        return iso_fault_set(fault, -ENOENT, "%s: no such person", name);
    }
    const int error = iso_gallery_db_remove(gallery->db, person->id, fault);
    if (error) {
        return error;
    }
    remove_entries(gallery, person->id);
    const size_t at = (size_t)(person - gallery->people);
    gallery->n_people--;
    memmove(gallery->people + at, gallery->people + at + 1,
            (gallery->n_people - at) * sizeof *gallery->people);
    return 0;
}

/* ---- looking ---- */

const struct iso_person *iso_gallery_people(const struct iso_gallery *gallery, size_t *n)
{
    *n = gallery->n_people;
    return gallery->people;
}

const struct iso_person *iso_gallery_find(const struct iso_gallery *gallery, const char *name)
{
    for (size_t i = 0; i < gallery->n_people; i++) {
        if (strcmp(gallery->people[i].name, name) == 0) {
            return &gallery->people[i];
        }
    }
    return NULL;
}

const struct iso_person *iso_gallery_find_id(const struct iso_gallery *gallery, int64_t id)
{
    return find_own(gallery, id);
}

const struct iso_search_entry *iso_gallery_entries(const struct iso_gallery *gallery, int *n)
{
    *n = (int)gallery->n_entries;
    return gallery->entries;
}

const struct iso_search_entry *iso_gallery_entries_of(const struct iso_gallery *gallery,
                                                      int64_t person, int *n)
{
    size_t first = 0, end;
    while (first < gallery->n_entries && gallery->entries[first].person != person) {
        first++;
    }
    end = first;
    while (end < gallery->n_entries && gallery->entries[end].person == person) {
        end++;
    }
    *n = (int)(end - first);
    return *n ? gallery->entries + first : NULL;
}
