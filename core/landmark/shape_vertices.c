#include "core/landmark/shape_vertices.h"

/* Adds up the partial sums of the rows of some vertices. */
static inline void add_partial_sums(const float *partial, int n_vertices, float *moved_mm)
{
    for (int i = 0; i < n_vertices * ISO_SHAPE_AXES; i++) {
        const float *p = &partial[i * ISO_GRAM_LANES];
        moved_mm[i] = p[0] + p[1] + p[2] + p[3];
    }
}

/* Three registers hold the partial sums of AT_ONCE vertices, one row of a chunk for each. They have
 * names, because compilers keep an array of them in memory. */
#define MAKE_VERTICES(WIDE, COEFFICIENTS)                                                      \
    typedef float wide __attribute__((vector_size((WIDE) * sizeof(float)), may_alias));        \
    enum { AT_ONCE = (WIDE) / ISO_GRAM_LANES };                                                \
    for (int i = 0; i < n; i += AT_ONCE) {                                                     \
        const float *at = modes + iso_shape_modes_of((size_t)i, stride);                       \
        wide sum[ISO_SHAPE_AXES], a = {0}, b = {0}, c = {0};                                   \
        for (int k = 0; k < stride; k += ISO_GRAM_LANES, at += ISO_SHAPE_GROUP_CHUNK) {        \
            const wide some = COEFFICIENTS(coefficient + k);                                   \
            a += some * *(const wide *)at;                                                     \
            b += some * *(const wide *)(at + (WIDE));                                          \
            c += some * *(const wide *)(at + 2 * (WIDE));                                      \
        }                                                                                      \
        sum[0] = a;                                                                            \
        sum[1] = b;                                                                            \
        sum[2] = c;                                                                            \
        add_partial_sums((const float *)sum, AT_ONCE, (float *)moved_mm + i * ISO_SHAPE_AXES); \
    }

#define ONCE(p) (*(const wide *)(p))
#define TWICE(p) \
    __builtin_shufflevector(iso_gram_lanes_at(p), iso_gram_lanes_at(p), 0, 1, 2, 3, 0, 1, 2, 3)

void iso__shape_vertices_baseline(const float *modes, int stride, const float *coefficient, int n,
                                  float (*moved_mm)[ISO_SHAPE_AXES])
{
    MAKE_VERTICES(4, ONCE)
}

#if defined __x86_64__
__attribute__((target("avx2"))) void iso__shape_vertices_avx2(const float *modes, int stride,
                                                              const float *coefficient, int n,
                                                              float (*moved_mm)[ISO_SHAPE_AXES])
{
    MAKE_VERTICES(8, TWICE)
}
#endif

void iso_shape_vertices(const float *modes, int stride, const float *coefficient, int n,
                        float (*moved_mm)[ISO_SHAPE_AXES])
{
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        iso__shape_vertices_avx2(modes, stride, coefficient, n, moved_mm);
        return;
    }
#endif
    iso__shape_vertices_baseline(modes, stride, coefficient, n, moved_mm);
}
