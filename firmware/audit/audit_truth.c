/* If the outcome of an exchange of files is not known, the log is opened again to find out which
 * file has which name. Nothing is written until this has succeeded. */
#include <errno.h>
#include <sodium.h>
#include <unistd.h>

#include "firmware/audit/audit_state.h"

/* The file is closed first, because the lock of this process would prevent opening it again. */
static void close_segment(struct iso_audit *audit)
{
    if (audit->fd >= 0) {
        (void)close(audit->fd);
        audit->fd = -1;
    }
}

static bool has_all(const struct iso_audit *found, const struct iso_audit *known)
{
    return found->last > known->last ||
           (found->last == known->last &&
            sodium_memcmp(&found->link, &known->link, sizeof found->link) == 0);
}

int iso__audit_recover(struct iso_audit *audit, struct iso_fault *fault)
{
    struct iso_audit *found = NULL;
    close_segment(audit);
    audit->lost = true;
    int error = iso_audit_open(&audit->options, audit->times, &found, fault);
    if (error) {
        return error;
    }
    if (!has_all(found, audit)) {
        error = iso_fault_set_code(fault, ISO_FAULT_LOG_OLD, -ESTALE,
                                   "%s: written records are missing", audit->path);
    } else {
        const struct iso_audit given_up = *audit;
        if (found->latest_s < audit->latest_s) {
            /* The latest date is in a segment that was not read. */
            found->latest_s = audit->latest_s;
        }
        *audit = *found;
        *found = given_up;
    }
    iso_audit_close(found);
    return error;
}
