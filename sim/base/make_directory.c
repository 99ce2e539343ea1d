#include "sim/base/make_directory.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

int sim_make_new_directory(const char *path, struct iso_fault *fault)
{
    if (mkdir(path, 0777) != 0) {
        return iso_fault_set(fault, -errno, "%s: %s", path, strerror(errno));
    }
    return 0;
}

int sim_make_directory(const char *path, struct iso_fault *fault)
{
    if (mkdir(path, 0777) != 0 && errno != EEXIST) {
        return iso_fault_set(fault, -errno, "%s: %s", path, strerror(errno));
    }
    return 0;
}
