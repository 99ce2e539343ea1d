/* Changes besides the templates. The name and the limits of validity are in the person's own
 * record, which is sealed again; the templates are bound to the person's number alone. Which
 * templates teach the metric is in the head. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "firmware/gallery/gallery_state.h"

static int no_such_person(const char *name, struct iso_fault *fault)
{
    return iso_fault_set(fault, -ENOENT, "%s: no such person", name);
}

/* Ends the transaction first, and then changes the memory, which cannot fail. */
static int update(struct iso_gallery *gallery, const struct iso_person *row,
                  struct iso_fault *fault)
{
    int64_t id = 0;
    int error = iso_gallery_db_begin(gallery->db, fault);
    if (error) {
        return error;
    }
    error = iso_gallery_db_put_person(gallery->db, row, &id, fault);
    error = iso_gallery_db_end(gallery->db, error, fault);
    if (!error) {
        *iso_gallery_memory_find(&gallery->memory, row->id) = *row;
    }
    return error;
}

int iso_gallery_may_rename(const struct iso_gallery *gallery, const char *name,
                           const char *new_name, struct iso_fault *fault)
{
    const struct iso_person *known = iso_gallery_find(gallery, name);
    const struct iso_person *holder = iso_gallery_find(gallery, new_name);
    const char *flaw = iso_person_name_flaw(new_name);
    if (!known) {
        return no_such_person(name, fault);
    }
    if (flaw) {
        return iso_fault_set(fault, -EINVAL, "%s", flaw);
    }
    if (holder && holder != known) {
        return iso_fault_set(fault, -EEXIST, "somebody else is enrolled as %s", holder->name);
    }
    return 0;
}

int iso_gallery_rename(struct iso_gallery *gallery, const char *name, const char *new_name,
                       struct iso_fault *fault)
{
    const int error = iso_gallery_may_rename(gallery, name, new_name, fault);
    if (error) {
        return error;
    }
    struct iso_person row = *iso_gallery_find(gallery, name);
    explicit_bzero(row.name, sizeof row.name); /* the old name may be the longer one */
    (void)snprintf(row.name, sizeof row.name, "%s", new_name);
    return iso_person_name_key(new_name, &row.key)
               ? iso_fault_set(fault, -ENOMEM, "gallery: out of memory")
               : update(gallery, &row, fault);
}

int iso_gallery_set_validity(struct iso_gallery *gallery, const char *name,
                             const struct iso_validity *validity, struct iso_fault *fault)
{
    const struct iso_person *known = iso_gallery_find(gallery, name);
    if (!known) {
        return no_such_person(name, fault);
    }
    if (validity->from_s < 0 || validity->until_s < 0 ||
        (validity->until_s != 0 && validity->until_s <= validity->from_s)) {
        return iso_fault_set(fault, -EINVAL, "the time of validity is empty");
    }
    struct iso_person row = *known;
    row.valid_from_s = validity->from_s;
    row.valid_until_s = validity->until_s;
    return update(gallery, &row, fault);
}

/* ---- the templates that teach ---- */

static int may_exclude(const struct iso_gallery *gallery, struct iso_fault *fault)
{
    const int error = iso_gallery_state(gallery, fault);
    if (error) {
        return error;
    }
    return gallery->memory.site && gallery->memory.adapt
               ? 0
               : iso_fault_set(fault, -EINVAL, "the metric does not adapt: [match] adapt = no");
}

/* Excludes the templates from `first` on and keeps the first `marks` marks. Ends the transaction
 * first, and then changes the memory, which cannot fail. */
static int exclude(struct iso_gallery *gallery, uint64_t first, int marks, struct iso_fault *fault)
{
    const int error = iso_gallery_db_begin(gallery->db, fault);
    if (error) {
        return error;
    }
    struct iso_site_record *record = iso_gallery_db_site(gallery->db);
    iso_site_record_exclude(record, first, iso_gallery_db_next(gallery->db));
    record->n_marks = marks;
    const int ended = iso_gallery_db_end(gallery->db, 0, fault);
    if (!ended) {
        iso_site_index_set_record(gallery->memory.site, record);
    }
    return ended;
}

int iso_gallery_reset_site(struct iso_gallery *gallery, size_t *n, struct iso_fault *fault)
{
    const int error = may_exclude(gallery, fault);
    if (error) {
        return error;
    }
    *n = iso_site_index_count(gallery->memory.site, 0, true);
    return *n > 0 ? exclude(gallery, 1, 0, fault) : 0;
}

int iso_gallery_roll_back_site(struct iso_gallery *gallery, size_t *n, struct iso_fault *fault)
{
    const int error = may_exclude(gallery, fault);
    if (error) {
        return error;
    }
    /* People of the last enrolments may have been removed, or excluded. */
    const struct iso_site_record *record = iso_gallery_db_site(gallery->db);
    int marks = record->n_marks;
    for (*n = 0; *n == 0 && marks > 0;) {
        *n = iso_site_index_count(gallery->memory.site, record->mark[--marks], true);
    }
    return *n > 0 ? exclude(gallery, record->mark[marks], marks, fault) : 0;
}

size_t iso_gallery_site_excluded(struct iso_gallery *gallery)
{
    return gallery->memory.site && !iso__gallery_is_lost(gallery)
               ? iso_site_index_count(gallery->memory.site, 0, false)
               : 0;
}
