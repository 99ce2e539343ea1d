#include "drivers/file/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { OPEN_FLAGS = O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC };

/* ---- the type of a file ---- */

static enum iso_fault_code code_of(int error)
{
    switch (error) {
    case -ENOENT:
    case -ENOTDIR:
        return ISO_FAULT_FILE_MISSING;
    case -EACCES:
    case -EPERM:
        return ISO_FAULT_FILE_DENIED;
    case -ELOOP:
    case -EISDIR:
    case -ENAMETOOLONG:
        return ISO_FAULT_FILE_UNFIT;
    case -ENOSPC:
    case -EDQUOT:
        return ISO_FAULT_DISK_FULL;
    case -EROFS:
        return ISO_FAULT_DISK_READ_ONLY;
    case -EIO:
        return ISO_FAULT_DISK_FAILED;
    default:
        return ISO_FAULT_NONE;
    }
}

int iso_file_fault(const char *path, int error, struct iso_fault *fault)
{
    return iso_fault_set_code(fault, code_of(error), error, "%s: %s", path, strerror(-error));
}

static int refuse_kind(const char *path, int error, const char *what, struct iso_fault *fault)
{
    return iso_fault_set_code(fault, ISO_FAULT_FILE_UNFIT, error, "%s: is %s, not a file", path,
                              what);
}

static int check_status(const char *path, const struct stat *status, uint64_t max_bytes,
                        struct iso_fault *fault)
{
    switch (status->st_mode & S_IFMT) {
    case S_IFREG:
        break;
    case S_IFDIR:
        return refuse_kind(path, -EISDIR, "a directory", fault);
    case S_IFLNK:
        return refuse_kind(path, -ELOOP, "a symbolic link", fault);
    case S_IFIFO:
        return refuse_kind(path, -EMEDIUMTYPE, "a FIFO", fault);
    case S_IFSOCK:
        return refuse_kind(path, -EMEDIUMTYPE, "a socket", fault);
    default:
        return refuse_kind(path, -EMEDIUMTYPE, "a device", fault);
    }
    return (uint64_t)status->st_size > max_bytes
               ? iso_fault_set_code(fault, ISO_FAULT_FILE_UNFIT, -EFBIG,
                                    "%s: longer than %llu bytes", path,
                                    (unsigned long long)max_bytes)
               : 0;
}

int iso_file_check(const char *path, uint64_t max_bytes, struct iso_fault *fault)
{
    struct stat status;
    return lstat(path, &status) ? iso_file_fault(path, -errno, fault)
                                : check_status(path, &status, max_bytes, fault);
}

/* ---- opening ---- */

/* A file that is opened to be written from the beginning is created again. The existing file of
 * that name may be a hard link to another file, which would be emptied, or may belong to a user who
 * could then read the new content. */
static bool makes_anew(int flags)
{
    return (flags & O_CREAT) && (flags & O_TRUNC);
}

static int take_away(const char *path, struct iso_fault *fault)
{
    return unlink(path) && errno != ENOENT ? iso_fault_set(fault, -errno, "%s: %m", path) : 0;
}

int iso_file_open(const char *path, int flags, uint64_t max_bytes, int *fd, struct iso_fault *fault)
{
    struct stat status;
    const uint64_t most = flags & O_TRUNC ? ISO_FILE_ANY_SIZE : max_bytes;
    if (lstat(path, &status) == 0) {
        /* If there is no file, open() makes it or reports why it cannot be opened. */
        int error = check_status(path, &status, most, fault);
        if (!error && makes_anew(flags)) {
            error = take_away(path, fault);
        }
        if (error) {
            return error;
        }
    }
    if (makes_anew(flags)) {
        flags = (flags & ~O_TRUNC) | O_EXCL;
    }
    const int opened = open(path, flags | OPEN_FLAGS, 0600);
    if (opened < 0) {
        return iso_file_fault(path, -errno, fault);
    }
    const int error = fstat(opened, &status) ? iso_file_fault(path, -errno, fault)
                                             : check_status(path, &status, max_bytes, fault);
    if (error) {
        (void)close(opened);
        return error;
    }
    *fd = opened;
    return 0;
}

int iso_file_stream(const char *path, uint64_t max_bytes, FILE **stream, struct iso_fault *fault)
{
    int fd = -1;
    const int error = iso_file_open(path, O_RDONLY, max_bytes, &fd, fault);
    if (error) {
        return error;
    }
    FILE *opened = fdopen(fd, "rb");
    if (!opened) {
        (void)close(fd);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    *stream = opened;
    return 0;
}

/* ---- reading ---- */

/* A file of /proc or /sys does not report its size, and other files may grow while they are read.
 * The reported size is therefore only the first capacity. */
static size_t first_capacity(int fd)
{
    struct stat status;
    return fstat(fd, &status) || status.st_size < 1 ? 4096 : (size_t)status.st_size + 1;
}

/* Reads to the end, or until `buffer` holds more than max_bytes. The caller frees *buffer, also
 * after a failure. */
static int read_all(int fd, size_t max_bytes, char **buffer, size_t *size)
{
    size_t capacity = first_capacity(fd), n = 0;
    ssize_t got = 1;
    *buffer = malloc(capacity + 1);
    while (*buffer && got > 0 && n <= max_bytes) {
        if (n == capacity) {
            char *grown = realloc(*buffer, 2 * capacity + 1);
            if (!grown) {
                return -ENOMEM;
            }
            *buffer = grown;
            capacity *= 2;
        }
        got = read(fd, *buffer + n, capacity - n);
        n += got > 0 ? (size_t)got : 0;
    }
    if (!*buffer || got < 0) {
        return *buffer ? -errno : -ENOMEM;
    }
    (*buffer)[n] = '\0';
    *size = n;
    return n > max_bytes ? -EFBIG : 0;
}

static int read_fault(const char *path, int error, size_t max_bytes, struct iso_fault *fault)
{
    switch (error) {
    case -EFBIG:
        return iso_fault_set_code(fault, ISO_FAULT_FILE_UNFIT, error, "%s: longer than %zu bytes",
                                  path, max_bytes);
    case -ENOMEM:
        return iso_fault_set(fault, error, "%s: out of memory", path);
    default:
        return iso_file_fault(path, error, fault);
    }
}

int iso_file_read(const char *path, size_t max_bytes, char **bytes, size_t *size,
                  struct iso_fault *fault)
{
    char *buffer = NULL;
    size_t n = 0;
    int fd = -1;
    int error = iso_file_open(path, O_RDONLY, max_bytes, &fd, fault);
    if (error) {
        return error;
    }
    error = read_all(fd, max_bytes, &buffer, &n);
    (void)close(fd);
    if (error) {
        free(buffer);
        return read_fault(path, error, max_bytes, fault);
    }
    *bytes = buffer;
    *size = n;
    return 0;
}
