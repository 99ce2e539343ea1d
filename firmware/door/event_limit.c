#include "firmware/door/event_limit.h"

#include "drivers/base/times.h"

static const int64_t second_ns = ISO_NS_PER_S, report_ns = 10 * ISO_NS_PER_S;

bool iso_event_limit_take(struct iso_event_limit *limit, int64_t now_ns)
{
    if (limit->folding) {
        limit->folded++;
        limit->newest_ns = now_ns;
        return false;
    }
    if (limit->passed == 0 || now_ns - limit->second_ns >= second_ns) {
        limit->second_ns = now_ns;
        limit->passed = 0;
    }
    if (limit->passed < ISO_EVENT_LIMIT_BURST) {
        limit->passed++;
        return true;
    }
    limit->folding = true;
    limit->folded = 1;
    limit->since_ns = limit->newest_ns = now_ns;
    return false;
}

bool iso_event_limit_report(struct iso_event_limit *limit, bool ending, int64_t now_ns,
                            struct iso_event_report *out)
{
    if (!limit->folding || (!ending && now_ns < iso_event_limit_due_ns(limit))) {
        return false;
    }
    const bool over = ending || now_ns - limit->newest_ns >= second_ns;
    const bool any = limit->folded > 0;
    *out = (struct iso_event_report){limit->folded, limit->newest_ns - limit->since_ns};
    limit->folding = !over;
    limit->passed = 0;
    limit->folded = 0;
    limit->since_ns = now_ns;
    return any;
}

int64_t iso_event_limit_due_ns(const struct iso_event_limit *limit)
{
    if (!limit->folding) {
        return ISO_NEVER_NS;
    }
    const int64_t quiet_ns = limit->newest_ns + second_ns, full_ns = limit->since_ns + report_ns;
    return quiet_ns < full_ns ? quiet_ns : full_ns;
}
