/* The factory reset: makes an appliance forget its people, its log, its settings, its accounts and
 * its fleet, such that a power cut at any moment leaves either everything as it was, or a reset
 * that the next start finishes.
 *
 *   begin    The marker is written and synchronised. From then on the daemon does not start, so the
 *            door admits nobody, and the reset can only go on.
 *   finish   1. The keys are overwritten and deleted. Nobody can read what they have sealed, even
 *               if the rest does not happen.
 *            2. The sealed files are deleted.
 *            3. The folders of the web server (accounts, its key) and of the link (the membership
 *               of a fleet) are emptied.
 *            4. The marker is deleted; or renamed, if there is a counter of the state, to which the
 *               daemon has to say that the stores are new because of a reset.
 *
 * Each step may be repeated. A flash memory may keep what was overwritten; a key that was a
 * credential bound to a TPM, or a disk that is encrypted, protects against that. */
#ifndef ISO_FIRMWARE_RESET_RESET_H
#define ISO_FIRMWARE_RESET_RESET_H

#include <stdbool.h>
#include <stddef.h>

#include "core/base/fault.h"

enum { ISO_RESET_PATH_SIZE = 512, ISO_RESET_KEYS = 3, ISO_RESET_STORES = 4, ISO_RESET_FOLDERS = 2 };

/* What is deleted. A key is one file, and the file PATH.new of a change that was cut short. A store
 * is also all files in its folder whose names continue its name with '.' or '-': "gallery.db" is
 * "gallery.db-wal" and "gallery.db.anchor", too. "" is nothing. */
struct iso_reset_places {
    char marker[ISO_RESET_PATH_SIZE];
    char done[ISO_RESET_PATH_SIZE];                       /* its new name; "": it is deleted */
    char keys[ISO_RESET_KEYS][ISO_RESET_PATH_SIZE];       /* overwritten before they are deleted */
    char stores[ISO_RESET_STORES][ISO_RESET_PATH_SIZE];   /* gallery, log, lock-out, settings */
    char folders[ISO_RESET_FOLDERS][ISO_RESET_PATH_SIZE]; /* emptied; may be missing */
};

/* Whether a reset was begun and is not finished. Also true if that cannot be found out. */
bool iso_reset_is_pending(const char *marker);

/* Begins a reset by writing the marker. Returns the errors of iso_data_file_replace; after an error
 * nothing has changed. */
int iso_reset_begin(const struct iso_reset_places *places, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Does what is left of a reset that was begun. No daemon may run. -EIO, -EROFS, -EACCES, -ENOMEM,
 * ... with a fault that names the file; then the marker stays, and the call can be repeated. */
int iso_reset_finish(const struct iso_reset_places *places, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
