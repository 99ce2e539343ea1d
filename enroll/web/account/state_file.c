#include "enroll/web/account/state_file.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/file/data_file.h"
#include "drivers/file/file.h"

/* Root may write the file for the user of the service, who owns the folder. */
static int give_to_owner(const char *path, struct iso_fault *fault)
{
    char folder[PATH_MAX];
    const char *slash = strrchr(path, '/');
    struct stat s;

    if (geteuid() != 0) {
        return 0;
    }
    (void)snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) : 1,
                   slash ? path : ".");
    if (stat(*folder ? folder : "/", &s) || lchown(path, s.st_uid, s.st_gid)) {
        return iso_file_fault(path, -errno, fault);
    }
    return 0;
}

int web_state_file_write(const char *path, const void *bytes, size_t size, struct iso_fault *fault)
{
    const int error = iso_data_file_replace(path, bytes, size, fault);

    return error ? error : give_to_owner(path, fault);
}
