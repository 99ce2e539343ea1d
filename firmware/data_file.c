#include "firmware/data_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

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
