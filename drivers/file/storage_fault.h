/* Faults of the disk, always in the same words, so that people recognise them everywhere:
 * "PATH: the disk refused: No space left on device". */
#ifndef ISO_DRIVERS_FILE_STORAGE_FAULT_H
#define ISO_DRIVERS_FILE_STORAGE_FAULT_H

#include <stdbool.h>

#include "core/base/fault.h"

/* Writes a fault: writing, synchronising or renaming `path` failed with `error` (a negative errno).
 * Returns -ENOSPC for a full disk, an exhausted quota and a limit on the size of files, -EROFS, and
 * -EIO for everything else. */
int iso_storage_refused(const char *path, int error, struct iso_fault *fault);

/* If `error`, the result of a call such as iso_file_open, is one of the disk, rewrites the fault in
 * the words above and returns what iso_storage_refused returns. Otherwise returns `error` (0: none)
 * and leaves the fault unchanged. */
int iso_storage_reword(const char *path, int error, struct iso_fault *fault);

/* Appends "; TEXT" to a fault. NULL: does nothing. */
void iso_storage_add(struct iso_fault *fault, const char *text);

/* Whether an error is one that iso_storage_refused returns. */
bool iso_storage_is_refusal(int error);

#endif
