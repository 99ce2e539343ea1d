#include "drivers/file/data_file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/file/directory.h"
#include "drivers/file/disk_wait.h"
#include "drivers/file/file.h"
#include "drivers/file/storage_fault.h"

int iso_data_file_read(const char *path, size_t max_bytes, void **bytes, size_t *size,
                       struct iso_fault *fault)
{
    char *read = NULL;
    const int error = iso_file_read(path, max_bytes, &read, size, fault);
    if (!error) {
        *bytes = read;
    }
    return iso_storage_reword(path, error, fault);
}

static int write_whole(int fd, const void *bytes, size_t size)
{
    const ssize_t written = write(fd, bytes, size);
    if (written < 0) {
        return -errno;
    }
    if ((size_t)written < size) {
        return -ENOSPC;
    }
    return iso_disk_wait_fsync(fd) ? -errno : 0;
}

int iso_data_file_replace(const char *path, const void *bytes, size_t size, struct iso_fault *fault)
{
    char beside[PATH_MAX];
    if (snprintf(beside, sizeof beside, "%s.new", path) >= PATH_MAX) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", path);
    }
    int fd = -1;
    int error = iso_file_open(beside, O_WRONLY | O_CREAT | O_TRUNC, ISO_FILE_ANY_SIZE, &fd, fault);
    if (error) {
        return iso_storage_reword(beside, error, fault);
    }
    error = write_whole(fd, bytes, size);
    (void)close(fd);
    if (!error && rename(beside, path)) {
        error = -errno;
    }
    if (error) {
        (void)unlink(beside);
        return iso_storage_refused(path, error, fault);
    }
    return iso_directory_sync(path, fault);
}

bool iso_data_file_holds(const char *path, const void *bytes, size_t size)
{
    void *read = NULL;
    size_t length = 0;
    if (iso_data_file_read(path, size, &read, &length, NULL)) {
        return false;
    }
    const bool same = length == size && memcmp(read, bytes, size) == 0;
    explicit_bzero(read, length);
    free(read);
    return same;
}

void iso_data_file_overwrite(int fd)
{
    static const unsigned char zeros[4096];
    const off_t size = lseek(fd, 0, SEEK_END);
    for (off_t at = 0; at < size; at += (off_t)sizeof zeros) {
        const off_t left = size - at;
        (void)!pwrite(fd, zeros, left < (off_t)sizeof zeros ? (size_t)left : sizeof zeros, at);
    }
    (void)iso_disk_wait_fsync(fd);
}
