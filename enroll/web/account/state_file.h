/* A small file of the web server's state, which is replaced as a whole or not at all. */
#ifndef WEB_ACCOUNT_STATE_FILE_H
#define WEB_ACCOUNT_STATE_FILE_H

#include <stddef.h>

#include "core/base/fault.h"

/* Writes `size` bytes to PATH.new (mode 0600, owner of the folder of `path`), synchronises it to
 * the disk and renames it to `path`. The program runs as root only for `setup-code`; the file then
 * belongs to the user of the service all the same. Returns 0, or a negative errno with a fault that
 * names the file. After an error the old file is unchanged; only if the folder cannot be
 * synchronised, the new one is in place and may not be on the disk yet. */
int web_state_file_write(const char *path, const void *bytes, size_t size, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
