#include "sim/base/result_file.h"

#include <errno.h>
#include <string.h>

#include "drivers/base/path.h"

int sim_result_file(const char *directory, const char *name, sim_result_writer *writer,
                    const void *context, struct iso_fault *fault)
{
    char path[PATH_MAX];
    int error = iso_path_join(directory, name, path, fault);
    if (error) {
        return error;
    }
    FILE *out = fopen(path, "we");
    if (!out) {
        return iso_fault_set(fault, -errno, "%s: %s", path, strerror(errno));
    }
    writer(context, out);
    int failed = ferror(out);
    if (fclose(out) != 0 || failed) {
        return iso_fault_set(fault, -EIO, "%s: cannot be written", path);
    }
    return 0;
}
