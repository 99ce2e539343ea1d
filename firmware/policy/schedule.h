/* Whether a schedule is active at a moment. Pure.
 *
 *   time UTC --zone--> what the clock on the wall shows: a date and a minute
 *        date on a special day of the schedule?  yes: the hours of that day's groups, together
 *                                                no:  the hours of the weekday
 *        minute in one of these hours?           yes: active
 *
 * So the answer depends only on what the clock on the wall shows. Where the clock is set back, an
 * hour comes twice, and a period of that hour is active both times. Where it is set forward, an
 * hour does not come at all, and a period is shorter by it; a period within it does not come that
 * day. This is chosen because people at the door can see the clock and nothing else: who may enter
 * from 8 until the clock shows 5 is let in until it shows 5. The other choice, a period as a length
 * of time from its beginning (RFC 5545 for a DURATION), would end at another time than the written
 * one.
 *
 * A period never passes midnight; what is meant to do so is two periods. A special day with no
 * hours in any of its groups is a day on which the schedule is never active. */
#ifndef ISO_FIRMWARE_POLICY_SCHEDULE_H
#define ISO_FIRMWARE_POLICY_SCHEDULE_H

#include "firmware/policy/policy.h"

/* What the clock on the wall shows. */
struct iso_wall_clock {
    int64_t day; /* calendar.h */
    int minute;  /* 0 to 1439 */
};

struct iso_wall_clock iso_wall_clock_at(const struct iso_zone *zone, int64_t time_s);

/* Whether a minute is in one of the periods. */
bool iso_day_hours_have(const struct iso_day_hours *hours, int minute);

/* Whether a date is in a group. */
bool iso_special_day_group_has(const struct iso_special_day_group *group, int64_t day);

/* The state of a schedule of the policy at a time, in seconds since 1970 UTC. */
enum iso_schedule_state iso_schedule_state_at(const struct iso_policy *policy,
                                              const struct iso_schedule *schedule, int64_t time_s);

/* Whether the state is active, on a special day or not. */
bool iso_schedule_state_is_active(enum iso_schedule_state state);

#endif
