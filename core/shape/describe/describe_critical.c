/* Methods of chapter 4: heat that is released at critical points. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "core/shape/describe/describe.h"
#include "core/shape/describe/heat_courses.h"
#include "core/shape/describe/scale_invariant.h"
#include "isotherm/signature.h"

enum {
    BINS = 100, /* 4.2.1, 4.3.3 */
    EIGENVALUES = ISO_SHAPE_PAIRS - 1,
    AMPLITUDES = 6,
};

/* The weight of the eigenvalues beside the histograms of CP-TD. */
static const double eigenvalue_weight = 3.0;

/* The time of the heat mean signature whose minimum is the one point of 4.2.3. */
static const double mean_time = 1.0 / 64.0;

/* The working memory. */
struct bench {
    const struct iso_shape *shape;
    int32_t n;      /* vertices */
    int n_times;    /* of the heat */
    double *t;      /* [n_times] */
    double *own;    /* [n_times]: the heat of one point at the point itself */
    double *heat;   /* [ISO_HEAT_ROWS][n_times]: the heat of one point at some vertices */
    double *weight; /* [n]: share of the area, divided by the number of points */
};

static int bench_init(struct bench *bench, const struct iso_shape *shape,
                      const struct iso_describe_times *times)
{
    const size_t n = (size_t)shape->mesh->n_vertices, n_times = (size_t)times->n;
    *bench = (struct bench){.shape = shape, .n = shape->mesh->n_vertices, .n_times = times->n};
    bench->t = malloc(n_times * sizeof *bench->t);
    bench->own = malloc(n_times * sizeof *bench->own);
    bench->heat = malloc(ISO_HEAT_ROWS * n_times * sizeof *bench->heat);
    bench->weight = malloc(n * sizeof *bench->weight);
    if (!bench->t || !bench->own || !bench->heat || !bench->weight) {
        return -ENOMEM;
    }
    iso_heat_times(times->first * shape->total_area, times->last * shape->total_area, times->n,
                   bench->t);
    return 0;
}

static void bench_done(struct bench *bench)
{
    free(bench->t);
    free(bench->own);
    free(bench->heat);
    free(bench->weight);
}

static void share_weight(struct bench *bench, int32_t n_points)
{
    for (int32_t v = 0; v < bench->n; v++) {
        bench->weight[v] = bench->shape->area[v] / (bench->shape->total_area * n_points);
    }
}

/* Adds the heat of one point: for each time, a histogram of the temperatures as shares, 0..1, of
 * the temperature at the point itself. */
static int add_temperatures(struct bench *bench, int32_t source, float *histogram)
{
    struct iso_heat_courses courses;
    const int n_times = bench->n_times;
    const int error = iso_heat_courses_init(&courses, bench->shape->pairs, source, 0, bench->t,
                                            n_times);
    if (!error) {
        iso_heat_courses_at(&courses, source, 1, bench->own);
    }
    for (int32_t from = 0; !error && from < bench->n; from += ISO_HEAT_ROWS) {
        const int32_t rows = iso_heat_rows_from(from, bench->n);
        iso_heat_courses_at(&courses, from, rows, bench->heat);
        for (int j = 0; j < n_times; j++) {
            iso_describe_histogram(&bench->heat[j], rows, n_times, &bench->weight[from], 0.0,
                                   bench->own[j], BINS, &histogram[(size_t)j * BINS]);
        }
    }
    iso_heat_courses_done(&courses);
    return error;
}

/* CP-TD. The histograms of all points are added, not concatenated: the points of two shapes have no
 * common order, and their numbers differ. */
static int describe_temperatures(const struct iso_shape *shape,
                                 const struct iso_describe_times *times,
                                 const struct iso_critical_points *points,
                                 struct iso_shape_description *out)
{
    const int32_t bins = times->n * BINS, sizes[] = {bins + EIGENVALUES};
    struct bench bench;
    int error = bench_init(&bench, shape, times);
    if (!error) {
        error = iso_describe_parts(out, 1, sizes);
    }
    if (!error) {
        share_weight(&bench, points->n);
        iso_describe_eigenvalues(shape, EIGENVALUES, eigenvalue_weight, &out->whole[bins]);
    }
    for (int32_t i = 0; !error && i < points->n; i++) {
        error = add_temperatures(&bench, points->vertex[i], out->whole);
    }
    bench_done(&bench);
    return error;
}

int iso_describe_cp_td(const struct iso_shape *shape, const struct iso_describe_times *times,
                       struct iso_shape_description *out)
{
    struct iso_critical_points points = {0};
    int error = iso_shape_critical_points(shape, &points);
    if (!error) {
        error = describe_temperatures(shape, times, &points, out);
    }
    iso_critical_points_done(&points);
    return error;
}

int iso_describe_cp_td_one(const struct iso_shape *shape, const struct iso_describe_times *times,
                           struct iso_shape_description *out)
{
    int32_t coldest = 0;
    double *mean = malloc((size_t)shape->mesh->n_vertices * sizeof *mean);
    int error = mean ? iso_heat_mean_signature(shape->pairs, mean_time * shape->total_area, mean)
                     : -ENOMEM;
    for (int32_t v = 0; !error && v < shape->mesh->n_vertices; v++) {
        coldest = mean[v] < mean[coldest] ? v : coldest;
    }
    struct iso_critical_points point = {1, &coldest};
    if (!error) {
        error = describe_temperatures(shape, times, &point, out);
    }
    free(mean);
    return error;
}

/* Amplitudes lie in 0..1 and their sum is 1; the higher ones lie in a smaller range. */
static double amplitude_range(int w)
{
    return w == 0 ? 0.5 : 0.25;
}

/* Adds a histogram of each amplitude of the courses of heat at some vertices. */
static int add_rows(struct bench *bench, const struct iso_fourier *fourier, int32_t from,
                    int32_t rows, float *histogram)
{
    float amplitude[ISO_HEAT_ROWS * AMPLITUDES];
    const int error = iso_si_hk(fourier, bench->heat, rows, amplitude);
    if (error) {
        return error;
    }
    for (int32_t i = 0; i < rows * AMPLITUDES; i++) {
        bench->heat[i] = (double)amplitude[i]; /* the courses are no longer needed */
    }
    for (int w = 0; w < AMPLITUDES; w++) {
        iso_describe_histogram(&bench->heat[w], rows, AMPLITUDES, &bench->weight[from], 0.0,
                               amplitude_range(w), BINS, &histogram[(size_t)w * BINS]);
    }
    return 0;
}

/* Adds the heat of one point at all vertices. The first eigenpair
 * is left out: it gives the constant to which the heat decays. */
static int add_amplitudes(struct bench *bench, const struct iso_fourier *fourier, int32_t source,
                          float *histogram)
{
    struct iso_heat_courses courses;
    int error = iso_heat_courses_init(&courses, bench->shape->pairs, source, 1, bench->t,
                                      bench->n_times);
    for (int32_t from = 0; !error && from < bench->n; from += ISO_HEAT_ROWS) {
        const int32_t rows = iso_heat_rows_from(from, bench->n);
        iso_heat_courses_at(&courses, from, rows, bench->heat);
        error = add_rows(bench, fourier, from, rows, histogram);
    }
    iso_heat_courses_done(&courses);
    return error;
}

/* The histograms of CP-HK. Shapes have the same weight whatever the number of their points. */
static int describe_amplitudes(const struct iso_shape *shape,
                               const struct iso_describe_times *times,
                               const struct iso_critical_points *points, float *histogram)
{
    struct bench bench;
    struct iso_fourier *fourier = NULL;
    int error = bench_init(&bench, shape, times);
    if (!error) {
        error = iso_fourier_new(times->n, AMPLITUDES, &fourier);
    }
    if (!error) {
        share_weight(&bench, points->n);
    }
    for (int32_t i = 0; !error && i < points->n; i++) {
        error = add_amplitudes(&bench, fourier, points->vertex[i], histogram);
    }
    iso_fourier_free(fourier);
    bench_done(&bench);
    return error;
}

/* The number of points is stored beside histograms whose sum is 1; one point more or less counts
 * 0.1. */
static const float per_point = 0.1f;

int iso_describe_cp_hk(const struct iso_shape *shape, const struct iso_describe_times *times,
                       struct iso_shape_description *out)
{
    const int32_t sizes[] = {BINS, BINS, BINS, BINS, BINS, BINS, 1, EIGENVALUES};
    _Static_assert(ISO_DESCRIBE_CP_HK_PLAIN_PARTS == AMPLITUDES + 1, "the parts before the last");
    struct iso_critical_points points = {0};
    int error = iso_shape_critical_points(shape, &points);
    if (!error) {
        error = iso_describe_parts(out, AMPLITUDES + 2, sizes);
    }
    if (!error) {
        error = describe_amplitudes(shape, times, &points, out->whole);
    }
    if (!error) {
        out->whole[AMPLITUDES * BINS] = per_point * (float)points.n;
        iso_describe_eigenvalues(shape, EIGENVALUES, 1.0, &out->whole[AMPLITUDES * BINS + 1]);
    }
    iso_critical_points_done(&points);
    return error;
}
