/* Faults of the disk in one form of words, so that people recognise them wherever they read them:
 * "PATH: the disk refused: No space left on device". */
#ifndef ISO_DRIVERS_FILE_STORAGE_FAULT_H
#define ISO_DRIVERS_FILE_STORAGE_FAULT_H

#include <stdbool.h>

#include "core/base/fault.h"

/* Describes that writing, synchronising or renaming `path` failed with `error` (a negative errno).
 * Returns -ENOSPC for a full disk, an exhausted quota and a limit on the size of files, -EROFS, and
 * -EIO for everything else. */
int iso_storage_refused(const char *path, int error, struct iso_fault *fault);

/* Puts the fault of a call such as open into the same words if its error is one of the disk.
 * Returns the error (0 is none), and leaves other faults as they are. */
int iso_storage_reword(const char *path, int error, struct iso_fault *fault);

/* Appends a half-sentence to a fault that was described. NULL: does nothing. */
void iso_storage_add(struct iso_fault *fault, const char *text);

/* Whether an error is one that iso_storage_refused returns. */
bool iso_storage_is_refusal(int error);

#endif
