/* Opens data files. All programs open their data files through these functions. The test
 * tests/gate/open_files.sh checks this; open_files.txt lists the exceptions.
 *
 * A path that is given to a program can lead to something else than a regular file. A FIFO waits
 * for a writer, /dev/zero has no end, opening a device can have an effect, a symbolic link leads to
 * another place, and a file may be larger than the memory. Therefore the kind of the file is
 * checked before it is opened. It is opened with O_NOFOLLOW, O_NONBLOCK, O_NOCTTY and O_CLOEXEC,
 * and its kind is checked again after that. Directories of the path may be symbolic links; the last
 * component must not be one.
 *
 * A function that fails leaves its outputs unchanged and writes one line that names the path.
 * Errors of all:
 *   -EISDIR       it is a directory
 *   -ELOOP        it is a symbolic link
 *   -EMEDIUMTYPE  it is a FIFO, a socket or a device
 *   -EFBIG        it is longer than max_bytes
 * Other errors are the errno of open() or fstat(); -ENOENT for a file that does not exist. */
#ifndef ISO_DRIVERS_FILE_FILE_H
#define ISO_DRIVERS_FILE_FILE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "core/base/fault.h"

/* For max_bytes: the caller reads piece by piece and needs no limit. */
#define ISO_FILE_ANY_SIZE UINT64_MAX

/* Writes a fault: a call of the system failed with `error` (a negative errno) for the file or
 * directory `path`, with the code that belongs to the error: FILE_MISSING, FILE_DENIED, FILE_UNFIT,
 * DISK_FULL, DISK_READ_ONLY, DISK_FAILED or none. Returns the error. */
int iso_file_fault(const char *path, int error, struct iso_fault *fault);

/* Returns 0 if `path` is a regular file of at most max_bytes. For files that a library opens by
 * itself. */
int iso_file_check(const char *path, uint64_t max_bytes, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Opens the file; `flags` are those of open(). A new file belongs to its owner alone (0600). With
 * O_CREAT | O_TRUNC the file is always created again: a regular file of that name is unlinked, and
 * its other names keep their content; -EEXIST if another process creates one in between. The caller
 * closes *fd. */
int iso_file_open(const char *path, int flags, uint64_t max_bytes, int *fd, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Opens the file for reading. The caller closes *stream with fclose(). Also -ENOMEM. */
int iso_file_stream(const char *path, uint64_t max_bytes, FILE **stream, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads the whole file into memory that the caller frees with free(). A NUL, which *size does not
 * count, follows the last byte. Also -ENOMEM and the errno of read(). */
int iso_file_read(const char *path, size_t max_bytes, char **bytes, size_t *size,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
