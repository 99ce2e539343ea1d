#include "drivers/sensor/picture/picture_pair.h"

#include <stdbool.h>

static int64_t apart(int64_t a, int64_t b)
{
    return a < b ? b - a : a - b;
}

enum iso_pair_verdict iso_pair_judge(const int64_t *first_ns, size_t n_first,
                                     const int64_t *second_ns, size_t n_second,
                                     int64_t tolerance_ns)
{
    if (n_first == 0 || n_second == 0) {
        return ISO_PAIR_WAIT;
    }
    const bool first_is_older = first_ns[0] < second_ns[0];
    const int64_t *older = first_is_older ? first_ns : second_ns;
    const size_t n_older = first_is_older ? n_first : n_second;
    int64_t other = first_is_older ? second_ns[0] : first_ns[0], gap = apart(older[0], other);
    const bool nearer_follows = n_older > 1 && apart(older[1], other) < gap;
    if (gap <= tolerance_ns && !nearer_follows) {
        return ISO_PAIR_TAKE;
    }
    return first_is_older ? ISO_PAIR_DROP_FIRST : ISO_PAIR_DROP_SECOND;
}
