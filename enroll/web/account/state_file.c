#include "enroll/web/account/state_file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/file/directory.h"
#include "drivers/file/file.h"

/* Root may write the file for the user of the service, who owns the folder. */
static int give_to_owner(int fd, const char *path)
{
    char folder[PATH_MAX];
    const char *slash = strrchr(path, '/');
    struct stat s;

    if (geteuid() != 0) {
        return 0;
    }
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) : 1, slash ? path : ".");
    if (stat(*folder ? folder : "/", &s) || fchown(fd, s.st_uid, s.st_gid)) {
        return -errno;
    }
    return 0;
}

static int write_whole(int fd, const char *bytes, size_t size)
{
    while (size > 0) {
        const ssize_t n = write(fd, bytes, size);
        if (n < 0 && errno != EINTR) {
            return -errno;
        }
        if (n > 0) {
            bytes += n;
            size -= (size_t)n;
        }
    }
    return fsync(fd) ? -errno : 0;
}

int web_state_file_write(const char *path, const void *bytes, size_t size, struct iso_fault *fault)
{
    char draft[PATH_MAX];
    int fd, r;

    if (snprintf(draft, sizeof draft, "%s.new", path) >= (int)sizeof draft) {
        return iso_file_fault(path, -ENAMETOOLONG, fault);
    }
    r = iso_file_open(draft, O_WRONLY | O_CREAT | O_TRUNC, ISO_FILE_ANY_SIZE, &fd, fault);
    if (r < 0) {
        return r;
    }
    r = give_to_owner(fd, path);
    if (r == 0) {
        r = write_whole(fd, bytes, size);
    }
    if (close(fd) && r == 0) {
        r = -errno;
    }
    if (r == 0 && rename(draft, path)) {
        r = -errno;
    }
    if (r < 0) {
        unlink(draft);
        return iso_file_fault(path, r, fault);
    }
    return iso_directory_sync(path, fault);
}
