#include "firmware/visit/suspension.h"

static const int64_t least_ns = 10 * ISO_NS_PER_MS;

/* Reads boot time first. If the thread loses its processor between the two readings, the time
 * asleep is then underestimated, and the program never sees a suspension that did not happen.
 * *now_ns is the monotonic time. */
static int64_t measure(const struct iso_times *times, int64_t *now_ns)
{
    const int64_t boot_ns = iso_times_boot_ns(times);
    *now_ns = iso_times_now_ns(times);
    return boot_ns - *now_ns;
}

void iso_suspension_init(struct iso_suspension *suspension, const struct iso_times *times)
{
    int64_t now_ns;
    suspension->asleep_ns = measure(times, &now_ns);
    suspension->awake_ns = INT64_MIN;
}

bool iso_suspension_look(struct iso_suspension *suspension, const struct iso_times *times)
{
    int64_t now_ns;
    const int64_t asleep_ns = measure(times, &now_ns);
    const bool suspended = asleep_ns - suspension->asleep_ns >= least_ns;
    if (asleep_ns > suspension->asleep_ns) {
        suspension->asleep_ns = asleep_ns;
    }
    if (suspended) {
        suspension->awake_ns = now_ns;
    }
    return suspended;
}
