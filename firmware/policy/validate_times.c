#include <errno.h>

#include "core/base/fault.h"
#include "firmware/policy/calendar.h"
#include "firmware/policy/validate_parts.h"

/* Periods of one day; `day` names it. */
static int validate_hours(const struct iso__record *record, const char *day,
                          const struct iso_day_hours *hours)
{
    if (hours->n > ISO_PERIODS_MAX) {
        return iso_fault_set(record->fault, -EINVAL, "%s \"%s\": %s: %d periods, at most %d",
                             record->kind, record->token, day, hours->n, ISO_PERIODS_MAX);
    }
    for (int i = 0; i < hours->n; i++) {
        const int from = hours->periods[i].from_min, to = hours->periods[i].to_min;
        const char *flaw = to <= from             ? "ends before it begins"
                           : to > ISO_DAY_MINUTES ? "ends after midnight"
                           : i > 0 && from < hours->periods[i - 1].to_min
                               ? "begins too early: "
                                 "periods ascend and do not "
                                 "overlap"
                               : NULL;
        if (flaw) {
            return iso_fault_set(
                record->fault, -EINVAL, "%s \"%s\": %s: the period %02d:%02d to %02d:%02d %s",
                record->kind, record->token, day, from / 60, from % 60, to / 60, to % 60, flaw);
        }
    }
    return 0;
}

static int validate_zones(const struct iso_policy *policy, struct iso_fault *fault)
{
    for (uint16_t i = 0; i < policy->n_zones; i++) {
        if (!iso_zone_is_sound(&policy->zones[i])) {
            return iso_fault_set(fault, -EINVAL, "zone number %u: is damaged", i);
        }
    }
    return 0;
}

static int validate_groups(const struct iso_policy *policy, struct iso_fault *fault)
{
    int error = 0;
    for (uint16_t i = 0; error == 0 && i < policy->n_groups; i++) {
        const struct iso_special_day_group *group = &policy->groups[i];
        const struct iso__record record = {"special day group", group->token, fault};
        error = iso__validate_token(record.kind, i, record.token, fault);
        error = error != 0 ? error
                           : iso__validate_count(&record, "days", group->n, ISO_SPECIAL_DAYS_MAX);
        for (int d = 1; error == 0 && d < group->n; d++) {
            if (group->days[d] <= group->days[d - 1]) {
                error = iso_fault_set(fault, -EINVAL, "%s \"%s\": its days are not ascending",
                                      record.kind, record.token);
            }
        }
    }
    return error;
}

static int validate_special(const struct iso_policy *policy, const struct iso_schedule *schedule,
                            const struct iso__record *record)
{
    int error = iso__validate_count(record, "special day groups", schedule->n_special,
                                    ISO_SPECIAL_SCHEDULES_MAX);
    for (int i = 0; error == 0 && i < schedule->n_special; i++) {
        const uint16_t group = schedule->special[i].group;
        error = iso__validate_index(record, "special day group", group, policy->n_groups);
        for (int k = 0; error == 0 && k < i; k++) {
            if (schedule->special[k].group == group) {
                error = iso_fault_set(record->fault, -EINVAL, "%s \"%s\": names \"%s\" twice",
                                      record->kind, record->token, policy->groups[group].token);
            }
        }
        error = error != 0 ? error
                           : validate_hours(record, policy->groups[group].token,
                                            &schedule->special[i].hours);
    }
    return error;
}

static int validate_schedule(const struct iso_policy *policy, const struct iso_schedule *schedule,
                             const struct iso__record *record)
{
    static const char *const weekdays[ISO_WEEKDAYS] = {"Sunday",   "Monday", "Tuesday", "Wednesday",
                                                       "Thursday", "Friday", "Saturday"};
    int error = iso__validate_index(record, "zone", schedule->zone, policy->n_zones);
    for (int day = 0; error == 0 && day < ISO_WEEKDAYS; day++) {
        error = validate_hours(record, weekdays[day], &schedule->weekly[day]);
    }
    return error != 0 ? error : validate_special(policy, schedule, record);
}

int iso__validate_times(const struct iso_policy *policy, struct iso_fault *fault)
{
    int error = validate_zones(policy, fault);
    error = error != 0 ? error : validate_groups(policy, fault);
    for (uint16_t i = 0; error == 0 && i < policy->n_schedules; i++) {
        const struct iso__record record = {"schedule", policy->schedules[i].token, fault};
        error = iso__validate_token(record.kind, i, record.token, fault);
        error = error != 0 ? error : validate_schedule(policy, &policy->schedules[i], &record);
    }
    return error;
}
