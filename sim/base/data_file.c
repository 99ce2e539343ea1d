#include "sim/base/data_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"

/* Describes the parser's error, or returns 0 if there is none. */
static int judge_parsing(int error, const char *path, const char *why, struct iso_fault *fault)
{
    if (!error) {
        return 0;
    }
    return iso_fault_set(fault, error, "%s: %s", path, error == -EBADMSG ? why : strerror(-error));
}

int sim_head_model_load(const char *path, struct iso_head_model **out, struct iso_fault *fault)
{
    char *bytes = NULL;
    size_t size = 0;
    const char *why = "";
    int error = iso_file_read(path, ISO_HEAD_BYTES_MAX, &bytes, &size, fault);
    if (!error) {
        error = judge_parsing(iso_head_model_parse(bytes, size, out, &why), path, why, fault);
        free(bytes);
    }
    return error;
}

int sim_metric_load(const char *path, struct iso_metric **out, struct iso_fault *fault)
{
    char *bytes = NULL;
    size_t size = 0;
    const char *why = "";
    int error = iso_file_read(path, ISO_METRIC_BYTES_MAX, &bytes, &size, fault);
    if (!error) {
        error = judge_parsing(iso_metric_parse(bytes, size, out, &why), path, why, fault);
        free(bytes);
    }
    return error;
}

int sim_cohort_load(const char *path, struct iso_cohort **out, struct iso_fault *fault)
{
    enum { BYTES_MAX = 1024 + ISO_COHORT_MAX * (ISO_TEMPLATE_BYTES_MAX + 4) };
    char *bytes = NULL;
    size_t size = 0;
    const char *why = "";
    int error = iso_file_read(path, BYTES_MAX, &bytes, &size, fault);
    if (!error) {
        error = judge_parsing(iso_cohort_parse(bytes, size, out, &why), path, why, fault);
        free(bytes);
    }
    return error;
}
