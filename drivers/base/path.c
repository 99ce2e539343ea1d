#include "drivers/base/path.h"

#include <errno.h>
#include <stdio.h>

int iso_path_join(const char *directory, const char *file, char path[PATH_MAX],
                  struct iso_fault *fault)
{
    const int length = snprintf(path, PATH_MAX, "%s/%s", directory, file);
    if (length < 0 || length >= PATH_MAX) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%.64s...: path too long", directory);
    }
    return 0;
}
