#include "core/surface/corners.h"

#include <string.h>

struct iso_corners iso_corners_of(const int32_t corner[3], int32_t triangle)
{
    const int32_t a = corner[0], b = corner[1], c = corner[2];
    const int32_t low = a < b ? a : b, high = a < b ? b : a;
    const int32_t least = low < c ? low : c, most = high > c ? high : c;
    return (struct iso_corners){{least, a ^ b ^ c ^ least ^ most, most}, triangle};
}

int iso_corners_compare(const void *a, const void *b)
{
    const struct iso_corners *p = a, *q = b;
    for (int k = 0; k < 3; k++) {
        if (p->sorted[k] != q->sorted[k]) {
            return p->sorted[k] < q->sorted[k] ? -1 : 1;
        }
    }
    return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

bool iso_corners_are_same(const struct iso_corners *a, const struct iso_corners *b)
{
    return memcmp(a->sorted, b->sorted, sizeof a->sorted) == 0;
}
