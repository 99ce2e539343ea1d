/* Changes of a person besides the templates: the name, and the limits of validity. Both are in the
 * person's own record, which is sealed again. The templates are bound to the person's number
 * alone. */
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
