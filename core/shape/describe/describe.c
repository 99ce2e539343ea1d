#include "core/shape/describe/describe.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

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

/* Leaves out the parts that a method does not keep. Sizes that are not used are 0. */
static void keep_parts(const struct iso_shape_method *method, struct iso_shape_description *d)
{
    while (method->kept_parts > 0 && d->n_parts > method->kept_parts) {
        d->part_size[--d->n_parts] = 0;
    }
}

int iso_shape_method_times(const struct iso_shape_method *method,
                           const struct iso_describe_times *chosen,
                           struct iso_describe_times *times)
{
    struct iso_describe_times found = method->times;
    if (found.n > 0 && chosen) {
        found.n = chosen->n ? chosen->n : found.n;
        found.first = chosen->first != 0.0 ? chosen->first : found.first;
        found.last = chosen->last != 0.0 ? chosen->last : found.last;
        if (found.n < ISO_DESCRIBE_TIMES_MIN || found.n > ISO_DESCRIBE_TIMES_MAX ||
            !(found.first > 0.0 && found.last > found.first && isfinite(found.last))) {
            return -EINVAL;
        }
    }
    *times = found;
    return 0;
}

int iso_shape_describe(const struct iso_shape_method *method, const struct iso_shape *shape,
                       struct iso_shape_description **out)
{
    return iso_shape_describe_at(method, shape, NULL, out);
}

int iso_shape_describe_at(const struct iso_shape_method *method, const struct iso_shape *shape,
                          const struct iso_describe_times *chosen,
                          struct iso_shape_description **out)
{
    struct iso_describe_times times;
    int error = iso_shape_method_times(method, chosen, &times);
    if (error) {
        return error;
    }
    if (method->colour && !shape->colour) {
        return -ENODATA;
    }
    struct iso_shape_description *d = calloc(1, sizeof *d);
    error = d ? method->describe(shape, &times, d) : -ENOMEM;
    if (error) {
        iso_shape_description_free(d);
        return error;
    }
    keep_parts(method, d);
    *out = d;
    return 0;
}

static float *copy_of(const float *values, size_t n)
{
    float *copy = values ? malloc((n + 1) * sizeof *copy) : NULL;
    if (copy) {
        memcpy(copy, values, n * sizeof *copy);
    }
    return copy;
}

int iso_describe_share(const struct iso_shape_method *method, const struct iso_shape_method *from,
                       const struct iso_shape_description *shared,
                       struct iso_shape_description **out)
{
    if (method->describe != from->describe ||
        (from->kept_parts > 0 &&
         (method->kept_parts == 0 || method->kept_parts > from->kept_parts))) {
        return -EINVAL;
    }
    struct iso_shape_description *d = calloc(1, sizeof *d);
    if (!d) {
        return -ENOMEM;
    }
    *d = *shared;
    keep_parts(method, d);
    size_t whole = 0, points = (size_t)d->n_points;
    for (int32_t p = 0; p < d->n_parts; p++) {
        whole += (size_t)d->part_size[p];
    }
    d->local = copy_of(shared->local, (size_t)d->n_bags * points * (size_t)d->n_values);
    d->weight = copy_of(shared->weight, points);
    d->whole = copy_of(shared->whole, whole);
    if (!d->local != !shared->local || !d->weight != !shared->weight ||
        !d->whole != !shared->whole) {
        iso_shape_description_free(d);
        return -ENOMEM;
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
