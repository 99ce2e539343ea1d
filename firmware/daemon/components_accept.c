/* Accepts stores of different ages as they are. An administrator decides this, and it is
 * recorded. */
#include <errno.h>
#include <stdlib.h>

#include "firmware/daemon/components.h"
#include "firmware/visit/lockout_file.h"

static int record(struct iso_components *components, const char *why, struct iso_fault *fault)
{
    const struct iso_gallery_version version = iso_gallery_version(components->gallery);
    struct iso_audit_record record = iso_audit_record_of("state-accepted");
    record.gallery = version.gallery;
    record.gallery_changes = version.changes;
    record.note = why;
    return iso_audit_append(components->audit, &record, fault);
}

/* A file that cannot be read may have contained a lockdown. The door then stays locked until
 * `lockdown off`. */
static int renew_lockout(const struct iso_components *components, struct iso_fault *fault)
{
    struct iso_lockout_file file;
    if (iso_lockout_load(components->lockout_path, components->ring, &file, NULL)) {
        file = (struct iso_lockout_file){.record = {.lockdown = true}};
    }
    return iso_lockout_save(components->lockout_path, components->ring, &file.record, fault);
}

/* Writes every file that knew of another one again. The log comes first, because the others must
 * know its head. After an interruption all of this is repeated. */
static int renew(struct iso_components *components, const char *why, struct iso_fault *fault)
{
    int error = record(components, why, fault);
    if (!error) {
        error = iso_audit_renew_anchor(components->audit, fault);
    }
    if (!error) {
        error = iso_key_ring_renew(components->ring, fault);
    }
    if (!error) {
        error = iso_gallery_renew(components->gallery, fault);
    }
    if (!error) {
        error = renew_lockout(components, fault);
    }
    if (!error) {
        /* This second record knows the gallery as it is now. */
        error = record(components, why, fault);
    }
    return error ? error : iso_audit_renew_anchor(components->audit, fault);
}

int iso_components_accept_stores(struct iso_components *components, struct iso_fault *why,
                                 struct iso_fault *fault)
{
    *why = (struct iso_fault){.text = ""};
    int error = iso_components_open_each_store(components, fault);
    if (error) {
        return error;
    }
    error = iso_components_compare_stores(components, why);
    if (error && error != -ESTALE) {
        /* The device of the counter has failed; an administrator's decision cannot help. */
        return iso_fault_set_code(fault, why->code, error, "%s", why->text);
    }
    if (!error) {
        return 0;
    }
    iso_heads_accept(iso_key_ring_board(components->ring));
    error = iso_components_begin_counter(components, false, fault);
    return error ? error : renew(components, why->text, fault);
}
