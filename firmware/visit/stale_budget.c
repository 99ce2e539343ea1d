#include "firmware/visit/stale_budget.h"

#include <errno.h>
#include <stdio.h>

#include "drivers/base/times.h"

void iso_stale_budget_measure(struct iso_stale_budget *budget, int64_t took_ns)
{
    budget->work_ns = budget->measured ? budget->work_ns + (took_ns - budget->work_ns) / 16
                                       : took_ns;
    budget->measured = true;
}

int64_t iso_stale_budget_needed_ns(const struct iso_stale_budget *budget)
{
    const double period_ns = budget->rate_hz > 0 ? (double)ISO_NS_PER_S / budget->rate_hz : 0;
    return (int64_t)(budget->agree * period_ns) + ISO_GRANT_WAIT_MS * ISO_NS_PER_MS +
           budget->work_ns;
}

bool iso_stale_budget_is_tight(const struct iso_stale_budget *budget, struct iso_fault *fault)
{
    const int64_t needed_ns = iso_stale_budget_needed_ns(budget);
    char frames[64] = "";
    if (needed_ns <= budget->stale_ns / 5 * 4) {
        return false;
    }
    if (budget->rate_hz > 0) {
        (void)snprintf(frames, sizeof frames, "%d frames at %.4g a second, ", budget->agree,
                       budget->rate_hz);
    }
    (void)iso_fault_set_code(
        fault, ISO_FAULT_TIME_SHORT, -ETIME,
        "a grant may need %lld ms (%s%d ms for its record, %lld ms of work), and "
        "[sensor] stale_ms is %lld: enrolled people may be refused as stale",
        (long long)(needed_ns / ISO_NS_PER_MS), frames, ISO_GRANT_WAIT_MS,
        (long long)(budget->work_ns / ISO_NS_PER_MS),
        (long long)(budget->stale_ns / ISO_NS_PER_MS));
    return true;
}
