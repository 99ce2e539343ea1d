/* Methods whose vertices become words: Shape Google, and those of chapter 5 for coloured shapes. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "core/shape/describe/describe.h"
#include "core/shape/describe/heat_courses.h"
#include "core/shape/describe/scale_invariant.h"
#include "isotherm/signature.h"

enum {
    GOOGLE_AMPLITUDES = 6,
    W_AMPLITUDES = 20,
    LEVELS = 4, /* of each channel in a histogram of colours */
};

static int make_bags(const struct iso_shape *shape, int32_t n_bags, int32_t n_values,
                     struct iso_shape_description *out)
{
    const size_t n = (size_t)shape->mesh->n_vertices;
    out->n_bags = n_bags;
    out->n_points = shape->mesh->n_vertices;
    out->n_values = n_values;
    out->local = calloc((size_t)n_bags * n * (size_t)n_values, sizeof *out->local);
    out->weight = calloc(n, sizeof *out->weight);
    if (!out->local || !out->weight) {
        return -ENOMEM;
    }
    for (size_t v = 0; v < n; v++) {
        out->weight[v] = (float)(shape->area[v] / shape->total_area);
    }
    return 0;
}

/* t = first 2^tau, tau from 0 in equal steps. */
static void fill_times(const struct iso_shape *shape, const struct iso_describe_times *times,
                       double t[ISO_DESCRIBE_TIMES_MAX])
{
    const double step = log2(times->last / times->first) / (times->n - 1);
    iso_heat_times_alpha(times->first * shape->total_area, 2.0, 0.0, step, times->n, t);
}

/* A way from courses of heat to scale-invariant amplitudes (scale_invariant.h). */
typedef int (*amplitudes)(const struct iso_fourier *fourier, const double *course,
                          int32_t n_courses, float *out);

/* Amplitudes of K(x, x, t) at every vertex, some vertices at a time. */
static int fill_amplitudes(const struct iso_eigenpairs *pairs, const double *t, int n_times,
                           const struct iso_fourier *fourier, int n_kept, amplitudes of,
                           float *local)
{
    struct iso_heat_courses courses;
    double *course = malloc((size_t)ISO_HEAT_ROWS * (size_t)n_times * sizeof *course);
    int error = iso_heat_courses_init(&courses, pairs, ISO_HEAT_OWN, 0, t, n_times);
    error = course ? error : -ENOMEM;
    for (int32_t from = 0; !error && from < pairs->n; from += ISO_HEAT_ROWS) {
        const int32_t rows = iso_heat_rows_from(from, pairs->n);
        iso_heat_courses_at(&courses, from, rows, course);
        error = of(fourier, course, rows, &local[(size_t)from * (size_t)n_kept]);
    }
    iso_heat_courses_done(&courses);
    free(course);
    return error;
}

/* Shape Google (Bronstein, Bronstein, Guibas and Ovsjanikov, ACM TOG 30, 2011): SI-HKS everywhere,
 * alpha = 2, the first 6 frequencies. */
int iso_describe_shape_google(const struct iso_shape *shape, const struct iso_describe_times *times,
                              struct iso_shape_description *out)
{
    double t[ISO_DESCRIBE_TIMES_MAX];
    struct iso_fourier *fourier = NULL;
    fill_times(shape, times, t);
    int error = make_bags(shape, 1, GOOGLE_AMPLITUDES, out);
    if (!error) {
        error = iso_describe_parts(out, 0, NULL);
    }
    if (!error) {
        error = iso_fourier_new(times->n - 1, GOOGLE_AMPLITUDES, &fourier);
    }
    if (!error) {
        error = fill_amplitudes(shape->pairs, t, times->n, fourier, GOOGLE_AMPLITUDES, iso_si_hks,
                                out->local);
    }
    iso_fourier_free(fourier);
    return error;
}

/* Scale-invariant amplitudes of K(x, x, t) for one operator, into one bag. */
static int amplitudes_of(const struct iso_eigenpairs *pairs, const double *t, int n_times,
                         float *local)
{
    struct iso_fourier *fourier = NULL;
    int error = iso_fourier_new(n_times, W_AMPLITUDES, &fourier);
    if (!error) {
        error = fill_amplitudes(pairs, t, n_times, fourier, W_AMPLITUDES, iso_si_hk, local);
    }
    iso_fourier_free(fourier);
    return error;
}

/* W-HKS of each channel (5.3), a bag for each. */
static int describe_channels(const struct iso_shape *shape, const struct iso_describe_times *times,
                             struct iso_shape_description *out)
{
    double t[ISO_DESCRIBE_TIMES_MAX];
    const size_t bag = (size_t)shape->mesh->n_vertices * W_AMPLITUDES;
    int error = make_bags(shape, ISO_CHANNELS, W_AMPLITUDES, out);
    fill_times(shape, times, t);
    for (int c = 0; !error && c < ISO_CHANNELS; c++) {
        error = amplitudes_of(shape->weighted[c], t, times->n, &out->local[(size_t)c * bag]);
    }
    return error;
}

/* Adds a colour to the histogram. Each channel is divided between the two levels next to it. */
static void add_colour(const struct iso_colour *colour, float weight, float *histogram)
{
    int level[ISO_CHANNELS];
    float above[ISO_CHANNELS];
    for (int c = 0; c < ISO_CHANNELS; c++) {
        const float at = colour->channel[c] * (float)(LEVELS - 1);
        level[c] = at >= (float)(LEVELS - 1) ? LEVELS - 2 : (int)at;
        above[c] = at - (float)level[c];
    }
    for (int corner = 0; corner < 8; corner++) {
        float share = weight;
        int cell = 0;
        for (int c = 0; c < ISO_CHANNELS; c++) {
            const int up = corner >> c & 1;
            share *= up ? above[c] : 1.0f - above[c];
            cell = cell * LEVELS + level[c] + up;
        }
        histogram[cell] += share;
    }
}

static int describe_colours(const struct iso_shape *shape, struct iso_shape_description *out)
{
    const int32_t sizes[] = {LEVELS * LEVELS * LEVELS};
    const int error = iso_describe_parts(out, 1, sizes);
    for (int32_t v = 0; !error && v < shape->mesh->n_vertices; v++) {
        add_colour(&shape->colour[v], out->weight[v], out->whole);
    }
    return error;
}

int iso_describe_w_hks1(const struct iso_shape *shape, const struct iso_describe_times *times,
                        struct iso_shape_description *out)
{
    int error = describe_channels(shape, times, out);
    if (!error) {
        error = iso_describe_parts(out, 0, NULL);
    }
    return error;
}

int iso_describe_w_hks2(const struct iso_shape *shape, const struct iso_describe_times *times,
                        struct iso_shape_description *out)
{
    int error = describe_channels(shape, times, out);
    if (!error) {
        error = describe_colours(shape, out);
    }
    return error;
}

int iso_describe_si_hk_colour(const struct iso_shape *shape, const struct iso_describe_times *times,
                              struct iso_shape_description *out)
{
    double t[ISO_DESCRIBE_TIMES_MAX];
    fill_times(shape, times, t);
    int error = make_bags(shape, 1, W_AMPLITUDES, out);
    if (!error) {
        error = amplitudes_of(shape->pairs, t, times->n, out->local);
    }
    if (!error) {
        error = describe_colours(shape, out);
    }
    return error;
}
