#include "firmware/fleet/door/fleet_term.h"

#include <string.h>

#include "drivers/base/times.h"

bool iso_fleet_term_was_given(const struct iso_fleet_term *term)
{
    return term->length_s > 0;
}

/* What is left of a length after some time; nothing if the time ran backwards. */
static int64_t left_of(int64_t length, int64_t elapsed)
{
    return elapsed < 0 || elapsed >= length ? 0 : length - elapsed;
}

int64_t iso_fleet_term_left_ns(const struct iso_fleet_term *term,
                               const struct iso_fleet_clocks *now)
{
    if (!iso_fleet_term_was_given(term)) {
        return 0;
    }
    if (memcmp(term->begin.boot_id, now->boot_id, sizeof now->boot_id) == 0) {
        return left_of(term->length_s * ISO_NS_PER_S, now->boot_ns - term->begin.boot_ns);
    }
    return term->begin.date_known && now->date_known
               ? left_of(term->length_s, now->date_s - term->begin.date_s) * ISO_NS_PER_S
               : 0;
}
