#include "core/shape/describe/describe.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

int iso_describe_parts(struct iso_shape_description *out, int32_t n_parts, const int32_t *part_size)
{
    size_t size = 0;
    for (int32_t p = 0; p < n_parts; p++) {
        out->part_size[p] = part_size[p];
        size += (size_t)part_size[p];
    }
    out->n_parts = n_parts;
    out->whole = calloc(size + 1, sizeof *out->whole);
    return out->whole ? 0 : -ENOMEM;
}

void iso_describe_histogram(const double *value, int32_t n, int stride, const double *weight,
                            double from, double to, int bins, float *histogram)
{
    const double scale = to > from ? bins / (to - from) : 0.0;
    for (int32_t i = 0; i < n; i++) {
        double at = (value[(size_t)i * (size_t)stride] - from) * scale - 0.5;
        at = fmin(fmax(at, 0.0), bins - 1.0);
        const int bin = at < bins - 2 ? (int)at : bins - 2;
        histogram[bin] += (float)(weight[i] * (1.0 - (at - bin)));
        histogram[bin + 1] += (float)(weight[i] * (at - bin));
    }
}

void iso_describe_eigenvalues(const struct iso_shape *shape, int n, double weight, float *out)
{
    const struct iso_eigenpairs *pairs = shape->pairs;
    double sum = 0.0, ranks = 0.0;
    for (int i = 1; i < pairs->k; i++) {
        sum += pairs->lambda[i];
        ranks += i;
    }
    for (int i = 1; i <= n; i++) {
        const bool there = i < pairs->k && sum > 0.0;
        const double evenly = there ? sum / ranks * i : 1.0;
        out[i - 1] = there ? (float)(weight * (pairs->lambda[i] / evenly - 1.0)) : 0.0f;
    }
}

int iso_shape_describe(const struct iso_shape_method *method, const struct iso_shape *shape,
                       struct iso_shape_description **out)
{
    if (method->colour && !shape->colour) {
        return -ENODATA;
    }
    struct iso_shape_description *d = calloc(1, sizeof *d);
    const int error = d ? method->describe(shape, d) : -ENOMEM;
    if (error) {
        iso_shape_description_free(d);
        return error;
    }
    *out = d;
    return 0;
}

void iso_shape_description_free(struct iso_shape_description *description)
{
    if (description) {
        free(description->local);
        free(description->weight);
        free(description->whole);
        free(description);
    }
}
