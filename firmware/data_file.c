#include "firmware/data_file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "firmware/directory.h"

static int read_stream(const char *path, FILE *file, size_t max_bytes, void **bytes, size_t *size,
                       struct iso_fault *fault)
{
    struct stat status;
    if (fstat(fileno(file), &status)) {
        return iso_fault_set(fault, -errno, "%s: %m", path);
    }
    if (!S_ISREG(status.st_mode)) {
        return iso_fault_set(fault, -EINVAL, "%s: not a file", path);
    }
    const size_t length = (size_t)status.st_size;
    if (length > max_bytes) {
        return iso_fault_set(fault, -EFBIG, "%s: longer than %zu bytes", path, max_bytes);
    }
    void *read = malloc(length + 1);
    if (!read) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    if (fread(read, 1, length, file) != length) {
        free(read);
        return iso_fault_set(fault, -EIO, "%s: cannot be read", path);
    }
    *bytes = read;
    *size = length;
    return 0;
}

int iso_data_file_read(const char *path, size_t max_bytes, void **bytes, size_t *size,
                       struct iso_fault *fault)
{
    FILE *file = fopen(path, "re");
    if (!file) {
        return iso_fault_set(fault, -errno, "%s: %m", path);
    }
    const int error = read_stream(path, file, max_bytes, bytes, size, fault);
    (void)fclose(file);
    return error;
}

static int write_whole(int fd, const void *bytes, size_t size)
{
    const ssize_t written = write(fd, bytes, size);
    if (written < 0) {
        return errno == EFBIG || errno == EDQUOT ? -ENOSPC : -errno;
    }
    if ((size_t)written < size) {
        return -ENOSPC;
    }
    return fsync(fd) ? -errno : 0;
}

int iso_data_file_replace(const char *path, const void *bytes, size_t size, struct iso_fault *fault)
{
    char beside[PATH_MAX];
    if (snprintf(beside, sizeof beside, "%s.new", path) >= PATH_MAX) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", path);
    }
    const int fd = open(beside, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (fd < 0) {
        return iso_fault_set(fault, -errno, "%s: %m", beside);
    }
    int error = write_whole(fd, bytes, size);
    (void)close(fd);
    if (!error && rename(beside, path)) {
        error = -errno;
    }
    if (error) {
        (void)unlink(beside);
        return iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
    }
    return iso_directory_sync(path, fault);
}

void iso_data_file_overwrite(int fd)
{
    static const unsigned char zeros[4096];
    const off_t size = lseek(fd, 0, SEEK_END);
    for (off_t at = 0; at < size; at += (off_t)sizeof zeros) {
        const off_t left = size - at;
        (void)!pwrite(fd, zeros, left < (off_t)sizeof zeros ? (size_t)left : sizeof zeros, at);
    }
    (void)fsync(fd);
}
