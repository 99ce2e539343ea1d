/* Reading a data file that the program is installed with. */
#ifndef ISO_FIRMWARE_DATA_FILE_H
#define ISO_FIRMWARE_DATA_FILE_H

#include <stddef.h>

#include "core/fault.h"

/* Reads a whole file of at most max_bytes into memory that the caller frees with free(). -EFBIG,
 * -ENOMEM, or the errno of opening and reading it; each with a fault that names the file. */
int iso_data_file_read(const char *path, size_t max_bytes, void **bytes, size_t *size,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
