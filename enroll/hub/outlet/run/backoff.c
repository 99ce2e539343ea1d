#include "enroll/hub/outlet/run/backoff.h"

enum { ASKED_MOST_S = 3600 };

int64_t hub__backoff_ms(uint64_t failures, int64_t asked_s, uint32_t random)
{
    int64_t most = HUB__BACKOFF_FIRST_MS;
    for (uint64_t i = 1; i < failures && most < HUB__BACKOFF_MOST_MS; i++) {
        most *= 2;
    }
    most = most < HUB__BACKOFF_MOST_MS ? most : HUB__BACKOFF_MOST_MS;
    const int64_t asked = 1000 * (asked_s < ASKED_MOST_S ? asked_s : ASKED_MOST_S);
    const int64_t wait = most / 2 + (int64_t)(random % (uint64_t)(most / 2 + 1));
    return wait < asked ? asked : wait;
}

bool hub__backoff_says(uint64_t failures)
{
    return failures > 0 && (failures & (failures - 1)) == 0;
}
