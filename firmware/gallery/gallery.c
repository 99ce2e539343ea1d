#include "firmware/gallery/gallery.h"

#include <errno.h>
#include <sodium.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/terminal/words.h"
#include "firmware/gallery/gallery_state.h"

/* ---- opening ---- */

int iso_gallery_open(const struct iso_gallery_options *options, struct iso_gallery **out,
                     struct iso_fault *fault)
{
    struct iso_gallery *gallery = calloc(1, sizeof *gallery);
    if (!gallery) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", options->path);
    }
    gallery->capacity = (size_t)options->capacity;
    int error = iso_gallery_db_open(options, &gallery->db, fault);
    if (!error) {
        error = iso_gallery_memory_load(gallery->db, options->algorithm, options->metric,
                                        options->adapt, NULL, &gallery->memory, fault);
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
        iso_gallery_memory_done(&gallery->memory);
        iso_gallery_db_close(gallery->db);
        free(gallery);
    }
}

/* ---- changing ---- */

int iso_gallery_room(const struct iso_gallery *gallery, const char *name, struct iso_fault *fault)
{
    const struct iso_person *person = iso_gallery_find(gallery, name);
    const char *flaw = person ? NULL : iso_person_name_flaw(name);
    if (flaw) {
        /* Only new names are checked; a name that the gallery has already may stay. */
        return iso_fault_set(fault, -EINVAL, "%s", flaw);
    }
    if (!person && gallery->memory.n_people >= gallery->capacity) {
        return iso_fault_set_code(fault, ISO_FAULT_GALLERY_FULL, -EDQUOT,
                                  "the gallery is full: %zu %s", gallery->memory.n_people,
                                  iso_plural(gallery->memory.n_people, "person", "people"));
    }
    if (person && person->templates >= ISO_GALLERY_TEMPLATES_MAX) {
        return iso_fault_set_code(fault, ISO_FAULT_GALLERY_FULL, -EDQUOT,
                                  "%s has %u templates, the most that one person can have",
                                  person->name, person->templates);
    }
    return 0;
}

/* Ends the transaction first, and then changes the memory, which cannot fail. */
static int add_prepared(struct iso_gallery *gallery, const struct iso_person *person,
                        const void *bytes, size_t size, struct iso_gallery_kept *kept,
                        struct iso_fault *fault)
{
    const struct iso_person *known = iso_gallery_find(gallery, person->name);
    struct iso_person row = *person;
    row.id = known ? known->id : 0;
    if (iso_person_name_key(row.name, &row.key)) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    if (known) {
        row.enrolled_s = known->enrolled_s;
        row.key = known->key;
        memcpy(row.name, known->name, sizeof row.name);
    }
    int error = iso_gallery_db_begin(gallery->db, fault);
    if (error) {
        return error;
    }
    error = iso_gallery_db_put_person(gallery->db, &row, &row.id, fault);
    if (!error) {
        error = iso_gallery_db_put_template(gallery->db, row.id, gallery->memory.algorithm, bytes,
                                            size, fault);
    }
    error = iso_gallery_db_end(gallery->db, error, fault);
    if (!error) {
        iso_gallery_memory_add(&gallery->memory, &row, kept);
    }
    return error;
}

static int check_addition(const struct iso_gallery *gallery, const struct iso_person *person,
                          const struct iso_template *tmpl, struct iso_fault *fault)
{
    if (tmpl->algorithm != gallery->memory.algorithm) {
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
    /* The template is written and read back, so that the search sees the same before and after a
     * restart. */
    struct iso_gallery_kept kept = {.tmpl = NULL};
    error = iso_gallery_memory_prepare(&gallery->memory, bytes, (size_t)size, &kept);
    if (error) {
        error = iso_fault_set(fault, error == -ENOMEM ? error : -EINVAL, "%s",
                              error == -ENOMEM ? "gallery: out of memory"
                                               : "the template is out of range");
    } else {
        error = add_prepared(gallery, person, bytes, (size_t)size, &kept, fault);
    }
    iso_gallery_memory_discard(&kept);
    sodium_memzero(bytes, sizeof bytes);
    return error;
}

int iso_gallery_remove(struct iso_gallery *gallery, const char *name, struct iso_fault *fault)
{
    const struct iso_person *person = iso_gallery_find(gallery, name);
    if (!person) {
        return iso_fault_set(fault, -ENOENT, "%s: no such person", name);
    }
    int error = iso_gallery_db_begin(gallery->db, fault);
    if (error) {
        return error;
    }
    error = iso_gallery_db_drop_person(gallery->db, person->id, fault);
    error = iso_gallery_db_end(gallery->db, error, fault);
    if (error) {
        return error;
    }
    iso_gallery_memory_remove(&gallery->memory, person->id);
    return 0;
}

/* ---- keys ---- */

int iso_gallery_rotate(struct iso_gallery *gallery, const struct iso_work_listener *listener,
                       struct iso_fault *fault)
{
    return iso_gallery_db_rotate(gallery->db, listener, fault);
}

int iso_gallery_renew(struct iso_gallery *gallery, struct iso_fault *fault)
{
    const int error = iso_gallery_db_begin(gallery->db, fault);
    return error ? error : iso_gallery_db_end(gallery->db, 0, fault);
}

int iso_gallery_renew_anchor(struct iso_gallery *gallery, struct iso_fault *fault)
{
    return iso_gallery_db_renew_anchor(gallery->db, fault);
}

struct iso_gallery_version iso_gallery_version(const struct iso_gallery *gallery)
{
    return iso_gallery_db_version(gallery->db);
}
