/* Small files as a whole: reading one, and putting a new one in its place. */
#ifndef ISO_FIRMWARE_DATA_FILE_H
#define ISO_FIRMWARE_DATA_FILE_H

#include <stddef.h>

#include "core/fault.h"

/* Reads a whole file of at most max_bytes into memory that the caller frees with free(). The
 * errors of iso_file_read (drivers/file/file.h), each with a fault that names the file. */
int iso_data_file_read(const char *path, size_t max_bytes, void **bytes, size_t *size,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Puts a file of the owner's alone in the place of `path`: it is written beside (PATH.new), is on
 * the disk, and is moved there. After a kill at any moment the old file is there or the new one.
 * The errno of what failed, with the old file in place; but that of synchronising the directory
 * comes when the new one is. */
int iso_data_file_replace(const char *path, const void *bytes, size_t size, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Overwrites what an open file holds with zeros, as far as that goes: a flash memory writes them
 * elsewhere. */
void iso_data_file_overwrite(int fd);

#endif
