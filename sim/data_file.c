#include "sim/data_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The whole file in memory that the caller frees. */
static int read_file(const char *path, size_t max_bytes, void **bytes, size_t *size,
                     struct iso_fault *fault)
{
    FILE *file = fopen(path, "rbe");
    if (!file) {
        return iso_fault_set(fault, -errno, "%s: %s", path, strerror(errno));
    }
    int error = 0;
    size_t n = 0;
    char *buffer = malloc(max_bytes + 1);
    if (!buffer) {
        error = iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
        goto out;
    }
    n = fread(buffer, 1, max_bytes + 1, file);
    if (ferror(file)) {
        error = iso_fault_set(fault, -EIO, "%s: cannot be read", path);
    } else if (n > max_bytes) {
        error = iso_fault_set(fault, -EFBIG, "%s: larger than %zu bytes", path, max_bytes);
    }
out:
    fclose(file);
    if (error) {
        free(buffer);
        return error;
    }
    *bytes = buffer;
    *size = n;
    return 0;
}

static int refuse(int error, const char *path, const char *why, struct iso_fault *fault)
{
    return error ? iso_fault_set(fault, error, "%s: %s", path,
                                 error == -EBADMSG ? why : strerror(-error))
                 : 0;
}

int sim_head_model_load(const char *path, struct iso_head_model **out, struct iso_fault *fault)
{
    void *bytes = NULL;
    size_t size = 0;
    const char *why = "";
    int error = read_file(path, ISO_HEAD_BYTES_MAX, &bytes, &size, fault);
    if (!error) {
        error = refuse(iso_head_model_parse(bytes, size, out, &why), path, why, fault);
        free(bytes);
    }
    return error;
}

int sim_cohort_load(const char *path, struct iso_cohort **out, struct iso_fault *fault)
{
    enum { BYTES_MAX = 1024 + ISO_COHORT_MAX * (ISO_TEMPLATE_BYTES_MAX + 4) };
    void *bytes = NULL;
    size_t size = 0;
    const char *why = "";
    int error = read_file(path, BYTES_MAX, &bytes, &size, fault);
    if (!error) {
        error = refuse(iso_cohort_parse(bytes, size, out, &why), path, why, fault);
        free(bytes);
    }
    return error;
}
