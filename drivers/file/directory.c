#include "drivers/file/directory.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "drivers/file/disk_wait.h"
#include "drivers/file/file.h"
#include "drivers/file/storage_fault.h"

int iso_directory_sync(const char *path, struct iso_fault *fault)
{
    char directory[PATH_MAX];
    const char *slash = strrchr(path, '/');
    const size_t length = slash ? (size_t)(slash - path) : 0;
    if (length >= sizeof directory) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", path);
    }
    (void)snprintf(directory, sizeof directory, "%.*s", (int)length, path);
    if (!slash) {
        strcpy(directory, ".");
    } else if (length == 0) {
        strcpy(directory, "/");
    }
    const int fd = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0) {
        const int error = iso_file_fault(directory, -errno, fault);
        return iso_storage_reword(directory, error, fault);
    }
    const int error = iso_disk_wait_fsync(fd) ? -errno : 0;
    (void)close(fd);
    return error ? iso_storage_refused(directory, error, fault) : 0;
}
