/* Sorts 16 vectors lane by lane: afterwards each lane rises from the first vector to the last. The
 * networks are those of K. E. Batcher, "Sorting networks and their applications", AFIPS 1968. All
 * functions are inlined, so that the vectors stay in registers. */
#ifndef ISO_CORE_FRAME_SORT_LANES_H
#define ISO_CORE_FRAME_SORT_LANES_H

#include "core/frame/depth_lanes.h"

#define ISO__INLINED static inline __attribute__((always_inline))

/* Exchanges the lanes of two vectors in which the second one is less. */
ISO__INLINED void iso__order(iso_depths *s, int first, int second)
{
    const iso_depths a = s[first], b = s[second];
    s[first] = ISO_DEPTHS_MIN(a, b);
    s[second] = ISO_DEPTHS_MAX(a, b);
}

ISO__INLINED void iso__sort_4(iso_depths *s)
{
    iso__order(s, 0, 1);
    iso__order(s, 2, 3);
    iso__order(s, 0, 2);
    iso__order(s, 1, 3);
    iso__order(s, 1, 2);
}

/* Merges the sorted halves of 8 vectors. */
ISO__INLINED void iso__merge_8(iso_depths *s)
{
    iso__order(s, 0, 4);
    iso__order(s, 1, 5);
    iso__order(s, 2, 6);
    iso__order(s, 3, 7);
    iso__order(s, 2, 4);
    iso__order(s, 3, 5);
    iso__order(s, 1, 2);
    iso__order(s, 3, 4);
    iso__order(s, 5, 6);
}

/* Merges the sorted halves of 16 vectors. */
ISO__INLINED void iso__merge_16(iso_depths *s)
{
    iso__order(s, 0, 8);
    iso__order(s, 1, 9);
    iso__order(s, 2, 10);
    iso__order(s, 3, 11);
    iso__order(s, 4, 12);
    iso__order(s, 5, 13);
    iso__order(s, 6, 14);
    iso__order(s, 7, 15);
    iso__order(s, 4, 8);
    iso__order(s, 5, 9);
    iso__order(s, 6, 10);
    iso__order(s, 7, 11);
    iso__order(s, 2, 4);
    iso__order(s, 3, 5);
    iso__order(s, 6, 8);
    iso__order(s, 7, 9);
    iso__order(s, 10, 12);
    iso__order(s, 11, 13);
    iso__order(s, 1, 2);
    iso__order(s, 3, 4);
    iso__order(s, 5, 6);
    iso__order(s, 7, 8);
    iso__order(s, 9, 10);
    iso__order(s, 11, 12);
    iso__order(s, 13, 14);
}

ISO__INLINED void iso_sort_lanes_16(iso_depths s[16])
{
    iso__sort_4(s);
    iso__sort_4(s + 4);
    iso__sort_4(s + 8);
    iso__sort_4(s + 12);
    iso__merge_8(s);
    iso__merge_8(s + 8);
    iso__merge_16(s);
}

#endif
