#include "sim/base/make_directory.h"

#include <errno.h>
#include <limits.h>
#include <string.h>
#include <sys/stat.h>

int sim_make_new_directory(const char *path, struct iso_fault *fault)
{
    if (mkdir(path, 0777) != 0) {
        return iso_fault_set(fault, -errno, "%s: %s", path, strerror(errno));
    }
    return 0;
}

/* Creates the directories above the last component. Errors are left to the last mkdir(), which
 * fails as well. */
static void make_parents(const char *path)
{
    char parent[PATH_MAX];
    if (strlen(path) >= sizeof parent) {
        return;
    }
    for (const char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        memcpy(parent, path, (size_t)(slash - path));
        parent[slash - path] = '\0';
        (void)mkdir(parent, 0777);
    }
}

int sim_make_directory(const char *path, struct iso_fault *fault)
{
    if (path[0] == '\0') {
        return iso_fault_set(fault, -ENOENT, "the name of a directory is empty");
    }
    make_parents(path);
    if (mkdir(path, 0777) != 0 && errno != EEXIST) {
        return iso_fault_set(fault, -errno, "%s: %s", path, strerror(errno));
    }
    struct stat status;
    if (stat(path, &status) != 0 || !S_ISDIR(status.st_mode)) {
        return iso_fault_set(fault, -ENOTDIR, "%s: not a directory", path);
    }
    return 0;
}
