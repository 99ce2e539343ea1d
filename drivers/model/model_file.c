#include "drivers/model/model_file.h"

#include <errno.h>
#include <stdlib.h>

#include "core/base/fault.h"
#include "drivers/file/data_file.h"

/* Parses the bytes of one kind of file. `out` points to the pointer that receives the object. */
typedef int parser(const void *bytes, size_t size, void *out, struct iso_fault *fault);

static int parse_head_model(const void *bytes, size_t size, void *out, struct iso_fault *fault)
{
    struct iso_head_model **model = out;
    return iso_head_model_parse(bytes, size, model, fault);
}

static int parse_metric(const void *bytes, size_t size, void *out, struct iso_fault *fault)
{
    struct iso_metric **metric = out;
    return iso_metric_parse(bytes, size, metric, fault);
}

static int parse_cohort(const void *bytes, size_t size, void *out, struct iso_fault *fault)
{
    struct iso_cohort **cohort = out;
    return iso_cohort_parse(bytes, size, cohort, fault);
}

static int load(const char *path, size_t bytes_max, parser *parse, void *out,
                struct iso_fault *fault)
{
    void *bytes = NULL;
    size_t size = 0;
    struct iso_fault why;
    int error = iso_data_file_read(path, bytes_max, &bytes, &size, fault);
    if (error) {
        return error;
    }
    error = parse(bytes, size, out, &why);
    free(bytes);
    if (error) {
        return iso_fault_set_code(
            fault, error == -ENOMEM ? ISO_FAULT_OUT_OF_MEMORY : ISO_FAULT_MODEL_DAMAGED, error,
            "%s: %s", path, why.text);
    }
    return 0;
}

int iso_head_model_load(const char *path, struct iso_head_model **out, struct iso_fault *fault)
{
    return load(path, ISO_HEAD_BYTES_MAX, parse_head_model, out, fault);
}

int iso_metric_load(const char *path, struct iso_metric **out, struct iso_fault *fault)
{
    return load(path, ISO_METRIC_BYTES_MAX, parse_metric, out, fault);
}

int iso_cohort_load(const char *path, struct iso_cohort **out, struct iso_fault *fault)
{
    enum { COHORT_BYTES_MAX = 64 + ISO_COHORT_MAX * (4 + ISO_TEMPLATE_BYTES_MAX) };
    return load(path, COHORT_BYTES_MAX, parse_cohort, out, fault);
}
