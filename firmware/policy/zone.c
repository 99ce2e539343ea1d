#include "firmware/policy/zone.h"

int32_t iso_zone_offset_s(const struct iso_zone *zone, int64_t time_s)
{
    /* How many changes lie at or before the time. */
    int low = 0, high = zone->n;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (zone->at_s[middle] <= time_s) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    if (low == zone->n) {
        return iso_zone_rule_offset_s(&zone->rule, time_s);
    }
    return low == 0 ? zone->first_offset_s : zone->offset_s[low - 1];
}
