#include "firmware/policy/schedule.h"

#include "firmware/policy/calendar.h"

struct iso_wall_clock iso_wall_clock_at(const struct iso_zone *zone, int64_t time_s)
{
    const int64_t local_s = time_s + iso_zone_offset_s(zone, time_s);
    const int64_t day = iso_calendar_floor_div(local_s, ISO_DAY_S);
    return (struct iso_wall_clock){.day = day, .minute = (int)((local_s - day * ISO_DAY_S) / 60)};
}

bool iso_day_hours_have(const struct iso_day_hours *hours, int minute)
{
    for (int i = 0; i < hours->n; i++) {
        if (minute >= hours->periods[i].from_min && minute < hours->periods[i].to_min) {
            return true;
        }
    }
    return false;
}

bool iso_special_day_group_has(const struct iso_special_day_group *group, int64_t day)
{
    int low = 0, high = group->n;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (group->days[middle] < day) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < group->n && group->days[low] == day;
}

enum iso_schedule_state iso_schedule_state_at(const struct iso_policy *policy,
                                              const struct iso_schedule *schedule, int64_t time_s)
{
    const struct iso_wall_clock now = iso_wall_clock_at(&policy->zones[schedule->zone], time_s);
    bool is_special = false, in_special_hours = false;
    for (int i = 0; i < schedule->n_special; i++) {
        const struct iso_special_hours *special = &schedule->special[i];
        if (iso_special_day_group_has(&policy->groups[special->group], now.day)) {
            is_special = true;
            in_special_hours |= iso_day_hours_have(&special->hours, now.minute);
        }
    }
    if (is_special) {
        return in_special_hours ? ISO_SCHEDULE_SPECIAL_ACTIVE : ISO_SCHEDULE_SPECIAL;
    }
    return iso_day_hours_have(&schedule->weekly[iso_calendar_weekday(now.day)], now.minute)
               ? ISO_SCHEDULE_ACTIVE
               : ISO_SCHEDULE_INACTIVE;
}

bool iso_schedule_state_is_active(enum iso_schedule_state state)
{
    return state == ISO_SCHEDULE_ACTIVE || state == ISO_SCHEDULE_SPECIAL_ACTIVE;
}
