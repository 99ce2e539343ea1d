/* Whole files in memory. */
#ifndef SIM_FILE_BYTES_H
#define SIM_FILE_BYTES_H

#include <stddef.h>

#include "core/fault.h"

/* Reads a file of at most max_bytes into memory that the caller frees with free(); a NUL that is
 * not counted follows it. -EFBIG, -EIO, -ENOMEM or the errno of open, each with a fault that names
 * the file. */
int sim_file_bytes(const char *path, size_t max_bytes, char **bytes, size_t *size,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
