/* Stores of different times, taken as they are: an administrator's decision, on record. */
#include <errno.h>
#include <stdlib.h>

#include "firmware/daemon/parts.h"
#include "firmware/visit/lockout_file.h"

static int record(struct iso_parts *parts, const char *why, struct iso_fault *fault)
{
    const struct iso_gallery_version version = iso_gallery_version(parts->gallery);
    struct iso_audit_record record = iso_audit_record_of("state-accepted");
    record.gallery = version.gallery;
    record.gallery_changes = version.changes;
    record.note = why;
    return iso_audit_append(parts->audit, &record, fault);
}

/* What cannot be read may have been the worst: the door stays shut until `lockdown off`. */
static int renew_lockout(const struct iso_parts *parts, struct iso_fault *fault)
{
    struct iso_lockout_file file;
    if (iso_lockout_load(parts->lockout_path, parts->ring, &file, NULL)) {
        file = (struct iso_lockout_file){.record = {.lockdown = true}};
    }
    return iso_lockout_save(parts->lockout_path, parts->ring, &file.record, fault);
}

/* Every file that knew of another one is written anew, the log before all others, as they are to
 * know its head. After an interruption it is done once more. */
static int renew(struct iso_parts *parts, const char *why, struct iso_fault *fault)
{
    int error = record(parts, why, fault);
    error = error ? error : iso_audit_renew_anchor(parts->audit, fault);
    error = error ? error : iso_key_ring_renew(parts->ring, fault);
    error = error ? error : iso_gallery_renew(parts->gallery, fault);
    error = error ? error : renew_lockout(parts, fault);
    error = error ? error : record(parts, why, fault); /* of the gallery as it is now */
    return error ? error : iso_audit_renew_anchor(parts->audit, fault);
}

int iso_parts_accept_stores(struct iso_parts *parts, struct iso_fault *why, struct iso_fault *fault)
{
    *why = (struct iso_fault){.text = ""};
    int error = iso_parts_open_each_store(parts, fault);
    if (error) {
        return error;
    }
    error = iso_parts_compare_stores(parts, why);
    if (error && error != -ESTALE) { /* the counter's device, about which nothing can be decided */
        return iso_fault_set_code(fault, why->code, error, "%s", why->text);
    }
    if (!error) {
        return 0;
    }
    iso_heads_accept(iso_key_ring_board(parts->ring));
    error = iso_parts_begin_counter(parts, false, fault);
    return error ? error : renew(parts, why->text, fault);
}
