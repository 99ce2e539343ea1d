#include "core/shape/describe/scale_invariant.h"

#include <cblas.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { ROWS = 256 }; /* courses that are transformed at once */

struct iso_fourier {
    int n, n_kept, n_frequencies;
    double *table; /* [n][2 n_frequencies]: cosine and sine of each frequency, side by side */
};

int iso_fourier_new(int n, int n_kept, struct iso_fourier **out)
{
    if (n < 4 || n_kept < 1 || n_kept > n / 2) {
        return -EINVAL;
    }
    struct iso_fourier *f = calloc(1, sizeof *f);
    if (!f) {
        return -ENOMEM;
    }
    *f = (struct iso_fourier){.n = n, .n_kept = n_kept, .n_frequencies = n / 2 + 1};
    f->table = malloc((size_t)n * 2 * (size_t)f->n_frequencies * sizeof *f->table);
    if (!f->table) {
        free(f);
        return -ENOMEM;
    }
    double *entry = f->table;
    for (int j = 0; j < n; j++) {
        for (int w = 0; w < f->n_frequencies; w++) {
            const double angle = 2.0 * M_PI * (double)((long)j * w % n) / n;
            *entry++ = cos(angle);
            *entry++ = sin(angle);
        }
    }
    *out = f;
    return 0;
}

void iso_fourier_free(struct iso_fourier *fourier)
{
    if (fourier) {
        free(fourier->table);
        free(fourier);
    }
}

static double amplitude(const double *spectrum, int w)
{
    return hypot(spectrum[2 * w], spectrum[2 * w + 1]);
}

/* The first frequencies of some courses: spectrum [rows][2 frequencies]. */
static void transform(const struct iso_fourier *f, const double *course, int rows, int stride,
                      int frequencies, double *spectrum)
{
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, rows, 2 * frequencies, f->n, 1.0, course,
                stride, f->table, 2 * f->n_frequencies, 0.0, spectrum, 2 * frequencies);
}

int iso_si_hk(const struct iso_fourier *f, const double *course, int32_t n_courses, float *out)
{
    const int frequencies = f->n_frequencies;
    double *spectrum = malloc((size_t)ROWS * 2 * (size_t)frequencies * sizeof *spectrum);
    if (!spectrum) {
        return -ENOMEM;
    }
    for (int32_t from = 0; from < n_courses; from += ROWS) {
        const int rows = n_courses - from < ROWS ? n_courses - from : ROWS;
        transform(f, &course[(size_t)from * (size_t)f->n], rows, f->n, frequencies, spectrum);
        for (int r = 0; r < rows; r++) {
            const double *s = &spectrum[(size_t)r * 2 * (size_t)frequencies];
            double sum = 0.0;
            for (int w = 0; w < frequencies; w++) {
                sum += amplitude(s, w);
            }
            for (int w = 0; w < f->n_kept; w++) {
                *out++ = sum > 0.0 ? (float)(amplitude(s, w) / sum) : 0.0f;
            }
        }
    }
    free(spectrum);
    return 0;
}

/* Differences of the logarithms of one course. */
static void log_differences(const double *course, int n, double *difference)
{
    double least = DBL_MAX;
    for (int j = 0; j < n; j++) {
        least = course[j] > 0.0 ? fmin(least, course[j]) : least;
    }
    least = least < DBL_MAX ? least : 1.0;
    for (int j = 1; j < n; j++) {
        difference[j - 1] = log(fmax(course[j], least)) - log(fmax(course[j - 1], least));
    }
}

int iso_si_hks(const struct iso_fourier *f, const double *course, int32_t n_courses, float *out)
{
    const int frequencies = f->n_kept;
    double *difference = malloc((size_t)ROWS * (size_t)f->n * sizeof *difference);
    double *spectrum = malloc((size_t)ROWS * 2 * (size_t)frequencies * sizeof *spectrum);
    if (!difference || !spectrum) {
        free(difference);
        free(spectrum);
        return -ENOMEM;
    }
    for (int32_t from = 0; from < n_courses; from += ROWS) {
        const int rows = n_courses - from < ROWS ? n_courses - from : ROWS;
        for (int r = 0; r < rows; r++) {
            log_differences(&course[(size_t)(from + r) * (size_t)(f->n + 1)], f->n + 1,
                            &difference[(size_t)r * (size_t)f->n]);
        }
        transform(f, difference, rows, f->n, frequencies, spectrum);
        for (int r = 0; r < rows; r++) {
            for (int w = 0; w < frequencies; w++) {
                *out++ = (float)amplitude(&spectrum[(size_t)r * 2 * (size_t)frequencies], w);
            }
        }
    }
    free(difference);
    free(spectrum);
    return 0;
}
