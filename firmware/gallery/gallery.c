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
        error = iso_gallery_memory_start(gallery->db, options, &gallery->memory, fault);
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
        iso_gallery_unstage(gallery);
        iso_gallery_memory_done(&gallery->memory);
        iso_gallery_db_close(gallery->db);
        free(gallery);
    }
}

/* ---- changing ---- */

int iso_gallery_room(const struct iso_gallery *gallery, const char *name, int n,
                     struct iso_fault *fault)
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
    const uint32_t before = person ? person->templates : 0;
    if (before + (uint32_t)n > ISO_GALLERY_TEMPLATES_MAX) {
        return iso_fault_set_code(fault, ISO_FAULT_GALLERY_FULL, -EDQUOT,
                                  "%s has %u templates, and %d more exceed the %d that one person "
                                  "can have",
                                  person ? person->name : name, before, n,
                                  ISO_GALLERY_TEMPLATES_MAX);
    }
    return 0;
}

/* A template to be added: as it is stored, and as it is kept in memory. */
struct addition {
    uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    size_t size;
    struct iso_gallery_kept kept;
};

static int put_templates(struct iso_gallery *gallery, int64_t person, struct addition *additions,
                         int n, struct iso_fault *fault)
{
    for (int i = 0; i < n; i++) {
        const int error = iso_gallery_db_put_template(
            gallery->db, person, gallery->memory.algorithm, additions[i].bytes, additions[i].size,
            &additions[i].kept.number, fault);
        if (error) {
            return error;
        }
    }
    return 0;
}

/* Ends the transaction first, and then changes the memory, which cannot fail. */
static int add_prepared(struct iso_gallery *gallery, const struct iso_person *person,
                        struct addition *additions, int n, struct iso_fault *fault)
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
    iso_gallery_db_mark(gallery->db);
    if (!error) {
        error = put_templates(gallery, row.id, additions, n, fault);
    }
    error = iso_gallery_db_end(gallery->db, error, fault);
    for (int i = 0; !error && i < n; i++) {
        iso_gallery_memory_add(&gallery->memory, &row, &additions[i].kept);
    }
    return error;
}

/* Makes the two forms of a template: the bytes that are stored, and the template that is kept in
 * memory. The latter is read from the bytes, so that a search has the same result before and after
 * a restart. */
static int prepare_addition(struct iso_gallery *gallery, const struct iso_template *tmpl,
                            struct addition *out, struct iso_fault *fault)
{
    if (tmpl->algorithm != gallery->memory.algorithm) {
        return iso_fault_set(fault, -EINVAL, "the template is of another algorithm");
    }
    const int size = iso_template_serialise(tmpl, out->bytes, sizeof out->bytes);
    if (size < 0) {
        return iso_fault_set(fault, -EINVAL, "the template is out of range");
    }
    out->size = (size_t)size;
    const int error = iso_gallery_memory_prepare(&gallery->memory, out->bytes, out->size,
                                                 &out->kept);
    if (error == -ENOMEM) {
        return iso_fault_set(fault, error, "gallery: out of memory");
    }
    return error ? iso_fault_set(fault, -EINVAL, "the template is out of range") : 0;
}

static int add_additions(struct iso_gallery *gallery, const struct iso_person *person,
                         const struct iso_template *const *templates, struct addition *additions,
                         int n, struct iso_fault *fault)
{
    for (int i = 0; i < n; i++) {
        const int error = prepare_addition(gallery, templates[i], &additions[i], fault);
        if (error) {
            return error;
        }
    }
    if (iso_gallery_memory_reserve(&gallery->memory, n)) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    return add_prepared(gallery, person, additions, n, fault);
}

int iso_gallery_add_all(struct iso_gallery *gallery, const struct iso_person *person,
                        const struct iso_template *const *templates, int n, struct iso_fault *fault)
{
    if (n < 1) {
        return iso_fault_set(fault, -EINVAL, "%s: no template to add", person->name);
    }
    int error = iso_gallery_room(gallery, person->name, n, fault);
    if (error) {
        return error;
    }
    struct addition *additions = calloc((size_t)n, sizeof *additions);
    if (!additions) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    error = add_additions(gallery, person, templates, additions, n, fault);
    for (int i = 0; i < n; i++) {
        iso_gallery_memory_discard(&additions[i].kept);
    }
    sodium_memzero(additions, (size_t)n * sizeof *additions);
    free(additions);
    return error;
}

int iso_gallery_add(struct iso_gallery *gallery, const struct iso_person *person,
                    const struct iso_template *tmpl, struct iso_fault *fault)
{
    return iso_gallery_add_all(gallery, person, &tmpl, 1, fault);
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
