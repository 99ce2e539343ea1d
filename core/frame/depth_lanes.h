/* Four depths of a frame at once, in one register of the plainest x86-64 and arm64: compilers make
 * single comparisons of wider vectors. A comparison of lanes gives -1 where it is true, else 0. */
#ifndef ISO_CORE_FRAME_DEPTH_LANES_H
#define ISO_CORE_FRAME_DEPTH_LANES_H

#if defined __SSE__
#include <xmmintrin.h>
#endif

enum { ISO_DEPTHS = 4 };

typedef float iso_depths __attribute__((vector_size(ISO_DEPTHS * sizeof(float))));
typedef int iso_depth_counts __attribute__((vector_size(ISO_DEPTHS * sizeof(int))));

/* Four depths in memory, aligned like one. */
typedef float iso_depths_in_memory
    __attribute__((vector_size(ISO_DEPTHS * sizeof(float)), aligned(4), may_alias));

#define ISO_DEPTHS_LOAD(p)         (*(const iso_depths_in_memory *)(p))
#define ISO_DEPTHS_STORE(p, value) (*(iso_depths_in_memory *)(p) = (value))

/* The lanes of a for which a comparison is true, and those of b for which it is false. */
static inline iso_depths iso_depths_choose(iso_depth_counts is, iso_depths a, iso_depths b)
{
    return (iso_depths)(((iso_depth_counts)a & is) | ((iso_depth_counts)b & ~is));
}

/* The smaller and the larger depth of each lane; b where they are equal, or one is not a number. */
#define ISO_DEPTHS_MIN_PLAIN(a, b) iso_depths_choose((a) < (b), a, b)
#define ISO_DEPTHS_MAX_PLAIN(a, b) iso_depths_choose((a) > (b), a, b)

/* The same, to the bit. Compilers do not make the one instruction of the processor from a
 * comparison and a choice. */
#if defined __SSE__
#define ISO_DEPTHS_MIN(a, b) ((iso_depths)_mm_min_ps(a, b))
#define ISO_DEPTHS_MAX(a, b) ((iso_depths)_mm_max_ps(a, b))
#else
#define ISO_DEPTHS_MIN(a, b) ISO_DEPTHS_MIN_PLAIN(a, b)
#define ISO_DEPTHS_MAX(a, b) ISO_DEPTHS_MAX_PLAIN(a, b)
#endif

#endif
