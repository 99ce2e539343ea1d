/* Pixels that agree with their surroundings: those of plain counting and sorting, and the same ones
 * on each kind of processor. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/surface/agreeing.h"

enum { WIDTH_MAX = 37, HEIGHT_MAX = 23, PIXELS_MAX = WIDTH_MAX * HEIGHT_MAX, NEIGHBOURS_MIN = 5 };
enum { SURROUNDINGS = 25 };

static const struct iso_agreeing_bounds bounds = {8.0f, 6.0f};

/* A slope with noise, flyers and holes, with any numbers behind it. */
static void make_plane(int width, int height, float depth_mm[PIXELS_MAX + ISO_AGREEING_SLACK])
{
    uint32_t state = (uint32_t)(width * 100 + height);
    for (int i = 0; i < width * height + ISO_AGREEING_SLACK; i++) {
        state = state * 1664525u + 1013904223u;
        const uint32_t chance = state >> 24;
        const float noise = (float)(state >> 8 & 0xff) / 64.0f;
        depth_mm[i] = 600.0f + 1.7f * (float)(i % width) + noise;
        depth_mm[i] += chance < 30 ? 9.0f : 0.0f;
        depth_mm[i] *= chance > 225 ? 0.0f : 1.0f;
    }
}

static int compare(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Whether no more than half of the sorted depths lie beyond the bound on either side. */
static bool near_median(const float *sorted, int n, float z)
{
    int below = 0, above = 0;
    for (int i = 0; i < n; i++) {
        below += sorted[i] - z < -bounds.median_mm;
        above += sorted[i] - z > bounds.median_mm;
    }
    /* With an odd number of depths the median itself says the same. */
    const bool near = 2 * below <= n && 2 * above <= n;
    if (n % 2 == 1) {
        assert_true(near == (fabsf(sorted[n / 2] - z) <= bounds.median_mm));
    }
    return near;
}

static bool agrees(const float *depth_mm, int width, int column, int row)
{
    const float z = depth_mm[row * width + column];
    float sorted[SURROUNDINGS];
    int n = 0, close = 0;
    for (int v = row - 2; v <= row + 2; v++) {
        for (int u = column - 2; u <= column + 2; u++) {
            const float near = depth_mm[v * width + u];
            if (near > 0.0f) {
                sorted[n++] = near;
                const bool beside = abs(u - column) <= 1 && abs(v - row) <= 1;
                close += beside && (u != column || v != row) &&
                         fabsf(near - z) < bounds.neighbour_mm;
            }
        }
    }
    qsort(sorted, (size_t)n, sizeof *sorted, compare);
    return z > 0.0f && close >= NEIGHBOURS_MIN && near_median(sorted, n, z);
}

/* Compares a function with the plain way. Returns how many inner pixels are kept. */
static int check(iso_agreeing_function *keep_agreeing, int width, int height)
{
    const size_t n = (size_t)width * (size_t)height;
    float *depth_mm = calloc(PIXELS_MAX + ISO_AGREEING_SLACK, sizeof *depth_mm);
    float *kept = malloc(n * sizeof *kept); /* a write behind it is found by the sanitizers */
    int n_kept = 0;
    assert_true(depth_mm && kept);
    make_plane(width, height, depth_mm);
    memset(kept, 0x7f, n * sizeof *kept);
    keep_agreeing(depth_mm, width, height, bounds, kept);
    for (int row = 0; row < height; row++) {
        for (int column = 0; column < width; column++) {
            const bool inner = row >= 2 && row < height - 2 && column >= 2 && column < width - 2;
            const bool is = inner && agrees(depth_mm, width, column, row);
            const float expected = is ? depth_mm[row * width + column] : 0.0f;
            assert_memory_equal(&kept[row * width + column], &expected, sizeof expected);
            n_kept += is;
        }
    }
    free(kept);
    free(depth_mm);
    return n_kept;
}

static void check_sizes(iso_agreeing_function *keep_agreeing)
{
    for (int width = 4; width <= WIDTH_MAX; width++) {
        for (int height = 4; height <= HEIGHT_MAX; height += 1 + width % 5) {
            (void)check(keep_agreeing, width, height);
        }
    }
    /* The plane has pixels of both kinds. */
    const int inner = (WIDTH_MAX - 4) * (HEIGHT_MAX - 4);
    const int kept = check(keep_agreeing, WIDTH_MAX, HEIGHT_MAX);
    assert_in_range(kept, inner / 8, inner - inner / 8);
}

static void the_baseline_keeps_what_agrees(void **state)
{
    (void)state;
    check_sizes(iso__keep_agreeing_baseline);
}

static void the_choice_keeps_what_agrees(void **state)
{
    (void)state;
    check_sizes(iso_keep_agreeing);
}

static void avx2_keeps_what_agrees(void **state)
{
    (void)state;
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        check_sizes(iso__keep_agreeing_avx2);
        return;
    }
#endif
    skip();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_baseline_keeps_what_agrees),
        cmocka_unit_test(the_choice_keeps_what_agrees),
        cmocka_unit_test(avx2_keeps_what_agrees),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
