/* Small files that are read as a whole, or replaced by a new one. */
#ifndef ISO_DRIVERS_FILE_DATA_FILE_H
#define ISO_DRIVERS_FILE_DATA_FILE_H

#include <stdbool.h>
#include <stddef.h>

#include "core/base/fault.h"

/* Reads a whole file of at most max_bytes into memory that the caller frees with free(). The errors
 * of iso_file_read (drivers/file/file.h), each with a fault that names the file. Errors of the disk
 * have the words of storage_fault.h, like those of iso_data_file_replace. */
int iso_data_file_read(const char *path, size_t max_bytes, void **bytes, size_t *size,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Replaces the file `path` by a new one that only its owner can read: it is written as PATH.new,
 * synchronised to the disk, and renamed. If the process is killed at any moment, the old or the new
 * file exists. The errors of iso_file_open for the new file, those of storage (storage_fault.h),
 * and -ENAMETOOLONG. After an error the old file is in place, or the new one if renaming it or
 * synchronising the directory failed; iso_data_file_holds finds out which. */
int iso_data_file_replace(const char *path, const void *bytes, size_t size, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Whether a file can be read and contains exactly these bytes. */
bool iso_data_file_holds(const char *path, const void *bytes, size_t size);

/* Overwrites the contents of an open file with zeros, as far as possible: a flash memory writes the
 * zeros to another place and may keep the old contents. Errors are ignored. */
void iso_data_file_overwrite(int fd);

#endif
