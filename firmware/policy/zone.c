#include "firmware/policy/zone.h"

#include <string.h>

static bool is_offset(int32_t offset_s)
{
    return offset_s >= ISO_ZONE_OFFSET_MIN_S && offset_s <= ISO_ZONE_OFFSET_MAX_S;
}

bool iso_zone_is_sound(const struct iso_zone *zone)
{
    if (zone->name[0] == '\0' || !memchr(zone->name, '\0', ISO_ZONE_NAME_SIZE) ||
        zone->n > ISO_ZONE_CHANGES_MAX || !is_offset(zone->first_offset_s)) {
        return false;
    }
    for (int i = 0; i < zone->n; i++) {
        if (!is_offset(zone->offset_s[i]) || (i > 0 && zone->at_s[i] <= zone->at_s[i - 1])) {
            return false;
        }
    }
    return iso_zone_rule_is_sound(&zone->rule);
}

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
