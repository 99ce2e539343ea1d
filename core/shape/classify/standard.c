#include "core/shape/classify/standard.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

/* Values that differ by less than this share of their size are the same but for rounding. */
static const double rounding = 1e-6;

/* Whether the values first..first + n - 1 are negative in no feature. */
static bool is_positive(const struct iso_labelled *training, int32_t first, int32_t n)
{
    const size_t size = (size_t)training->layout->size;
    for (int32_t i = 0; i < training->n; i++) {
        for (int32_t j = first; j < first + n; j++) {
            if (training->feature[(size_t)i * size + (size_t)j] < 0.0f) {
                return false;
            }
        }
    }
    return true;
}

bool iso_standard_compressible(const struct iso_labelled *training)
{
    const struct iso_feature_layout *layout = training->layout;
    for (int32_t p = 0, first = 0; p < layout->n_parts; p++) {
        if (is_positive(training, first, layout->part_size[p])) {
            return true;
        }
        first += layout->part_size[p];
    }
    return false;
}

static double compress(enum iso_compression compression, double value)
{
    switch (compression) {
    case ISO_COMPRESSION_ROOT:
        return sqrt(fmax(value, 0.0));
    case ISO_COMPRESSION_LOGARITHM:
        return log1p(fmax(value, 0.0));
    default:
        return value;
    }
}

/* The mean of value number j, and its standard deviation; 0 if it does not vary. */
static double deviation_of(const struct iso_labelled *training, enum iso_compression compression,
                           int32_t j, double *mean)
{
    const size_t size = (size_t)training->layout->size;
    double sum = 0.0, square = 0.0, largest = 0.0;
    for (int32_t i = 0; i < training->n; i++) {
        const double x = compress(compression,
                                  (double)training->feature[(size_t)i * size + (size_t)j]);
        sum += x;
        largest = fmax(largest, fabs(x));
    }
    *mean = sum / training->n;
    for (int32_t i = 0; i < training->n; i++) {
        const double x = compress(compression,
                                  (double)training->feature[(size_t)i * size + (size_t)j]);
        square += (x - *mean) * (x - *mean);
    }
    const double deviation = sqrt(square / training->n);
    return deviation > rounding * largest ? deviation : 0.0;
}

/* Learns the values first..first + n - 1, which are one part. */
static void learn_part(const struct iso_labelled *training, enum iso_compression compression,
                       int32_t first, int32_t n, struct iso_standard *s)
{
    const bool alone = compression == ISO_COMPRESSION_LOGARITHM;
    double square = 0.0;
    for (int32_t j = first; j < first + n; j++) {
        const double deviation = deviation_of(training, compression, j, &s->mean[j]);
        square += alone ? deviation > 0.0 : deviation * deviation;
        s->scale[j] = deviation;
    }
    for (int32_t j = first; j < first + n; j++) {
        if (s->scale[j] > 0.0) {
            s->scale[j] = 1.0 / ((alone ? s->scale[j] : 1.0) * sqrt(square));
        }
    }
}

int iso_standard_init(struct iso_standard *standard, const struct iso_labelled *training,
                      enum iso_compression compression, double length)
{
    const struct iso_feature_layout *layout = training->layout;
    struct iso_standard s = {.layout = *layout, .length = length};
    s.mean = calloc((size_t)layout->size, sizeof *s.mean);
    s.scale = calloc((size_t)layout->size, sizeof *s.scale);
    if (!s.mean || !s.scale) {
        iso_standard_done(&s);
        return -ENOMEM;
    }
    for (int32_t p = 0, first = 0; p < layout->n_parts; p++) {
        const bool positive = is_positive(training, first, layout->part_size[p]);
        s.compression[p] = positive ? compression : ISO_COMPRESSION_NONE;
        learn_part(training, s.compression[p], first, layout->part_size[p], &s);
        first += layout->part_size[p];
    }
    *standard = s;
    return 0;
}

void iso_standard_done(struct iso_standard *standard)
{
    free(standard->mean);
    free(standard->scale);
    *standard = (struct iso_standard){0};
}

void iso_standard_apply(const struct iso_standard *standard, float *feature)
{
    const struct iso_feature_layout *layout = &standard->layout;
    double square = 0.0;
    for (int32_t p = 0, j = 0; p < layout->n_parts; p++) {
        for (int32_t k = 0; k < layout->part_size[p]; k++, j++) {
            const double x = compress(standard->compression[p], (double)feature[j]);
            feature[j] = (float)((x - standard->mean[j]) * standard->scale[j]);
            square += (double)feature[j] * (double)feature[j];
        }
    }
    const double factor = square > 0.0 ? standard->length / sqrt(square) : 0.0;
    for (int32_t j = 0; j < layout->size; j++) {
        feature[j] = (float)((double)feature[j] * factor);
    }
}
