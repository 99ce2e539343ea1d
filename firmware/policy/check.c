#include "firmware/policy/check.h"

#include <stdio.h>

#include "firmware/policy/calendar.h"
#include "firmware/policy/decide.h"
#include "firmware/policy/schedule.h"

struct findings {
    struct iso_policy_finding *first;
    size_t n, max;
};

static void add(struct findings *findings, enum iso_policy_flaw flaw, uint32_t index)
{
    if (findings->n < findings->max) {
        findings->first[findings->n] = (struct iso_policy_finding){flaw, index};
    }
    findings->n++;
}

/* Whether the schedule is active at any time from now on. Today counts as a whole. */
static bool is_ever_active(const struct iso_policy *policy, const struct iso_schedule *schedule,
                           int64_t now_s)
{
    for (int day = 0; day < ISO_WEEKDAYS; day++) {
        if (schedule->weekly[day].n > 0) {
            return true;
        }
    }
    const int64_t today = iso_wall_clock_at(&policy->zones[schedule->zone], now_s).day;
    for (int i = 0; i < schedule->n_special; i++) {
        const struct iso_special_day_group *group = &policy->groups[schedule->special[i].group];
        if (schedule->special[i].hours.n > 0 && group->n > 0 &&
            group->days[group->n - 1] >= today) {
            return true;
        }
    }
    return false;
}

/* Whether somebody with these identifiers can pass one of the levels that the access point may ask
 * for. */
static bool has_level_for(const struct iso_policy *policy, const struct iso_access_point *point,
                          uint8_t identifiers)
{
    const struct iso_authentication_profile *profile =
        &policy->authentication_profiles[point->authentication_profile];
    bool passes = iso_security_level_can_pass(&policy->levels[profile->default_level], identifiers);
    for (int i = 0; i < profile->n_policies; i++) {
        for (int s = 0; s < ISO_SCHEDULE_STATES; s++) {
            const uint16_t level = profile->policies[i].constraints[s].level;
            passes |= level != ISO_INDEX_NONE &&
                      iso_security_level_can_pass(&policy->levels[level], identifiers);
        }
    }
    return passes;
}

/* Whether an access policy leads somewhere for somebody with these identifiers. */
static bool leads(const struct iso_policy *policy, const struct iso_access_policy *access,
                  uint8_t identifiers, int64_t now_s)
{
    const struct iso_access_point *point = &policy->access_points[access->access_point];
    return point->enabled && is_ever_active(policy, &policy->schedules[access->schedule], now_s) &&
           has_level_for(policy, point, identifiers);
}

static bool may_be_valid(const struct iso_credential *credential, int64_t now_s)
{
    return credential->enabled && (credential->valid_to_s == 0 || now_s < credential->valid_to_s);
}

/* The access points at which somebody enters, as bits. */
struct entered {
    uint8_t bits[(UINT16_MAX + 1) / 8];
};

static bool is_entered(const struct entered *entered, uint16_t access_point)
{
    return (entered->bits[access_point / 8] >> (access_point % 8) & 1) != 0;
}

/* Whether the credential can enter anywhere; adds the access points to *entered. */
static bool enters(const struct iso_policy *policy, const struct iso_credential *credential,
                   int64_t now_s, struct entered *entered)
{
    bool somewhere = false;
    for (int i = 0; i < credential->n_profiles; i++) {
        const struct iso_access_profile *profile =
            &policy->access_profiles[credential->profiles[i]];
        for (int p = 0; p < profile->n_policies; p++) {
            const uint16_t point = profile->policies[p].access_point;
            if (somewhere && is_entered(entered, point)) {
                continue; /* nothing to learn: this keeps the check of a large policy short */
            }
            if (leads(policy, &profile->policies[p], credential->identifiers, now_s)) {
                somewhere = true;
                entered->bits[point / 8] |= (uint8_t)(1 << (point % 8));
            }
        }
    }
    return somewhere;
}

size_t iso_policy_check(const struct iso_policy *policy, int64_t now_s,
                        struct iso_policy_finding *findings, size_t max)
{
    struct findings found = {.first = findings, .max = max};
    struct entered entered = {0};
    for (uint16_t i = 0; i < policy->n_schedules; i++) {
        if (!is_ever_active(policy, &policy->schedules[i], now_s)) {
            add(&found, ISO_POLICY_SCHEDULE_NEVER, i);
        }
    }
    for (uint32_t i = 0; i < policy->n_credentials; i++) {
        const struct iso_credential *credential = &policy->credentials[i];
        if (may_be_valid(credential, now_s) && !enters(policy, credential, now_s, &entered)) {
            add(&found, ISO_POLICY_PERSON_NOWHERE, i);
        }
    }
    for (uint16_t i = 0; i < policy->n_access_points; i++) {
        /* Without identifiers only an open level can be passed. */
        if (policy->access_points[i].enabled && !is_entered(&entered, i) &&
            !has_level_for(policy, &policy->access_points[i], 0)) {
            add(&found, ISO_POLICY_POINT_WITHOUT_WAY, i);
        }
    }
    return found.n;
}

const char *iso_policy_finding_text(const struct iso_policy *policy,
                                    const struct iso_policy_finding *finding,
                                    char text[ISO_POLICY_FINDING_TEXT_SIZE])
{
    const uint32_t i = finding->index;
    const char *kind = "", *token = "", *flaw = "";
    switch (finding->flaw) {
    case ISO_POLICY_SCHEDULE_NEVER:
        kind = "schedule", token = policy->schedules[i].token, flaw = "is never active";
        break;
    case ISO_POLICY_PERSON_NOWHERE:
        kind = "credential", token = policy->credentials[i].token,
        flaw = "is enabled, and no access policy ever lets it in";
        break;
    case ISO_POLICY_POINT_WITHOUT_WAY:
    case ISO_POLICY_FLAWS:
        kind = "access point", token = policy->access_points[i].token,
        flaw = "lets nobody in at any time";
        break;
    }
    (void)snprintf(text, ISO_POLICY_FINDING_TEXT_SIZE, "%s \"%s\" %s", kind, token, flaw);
    return text;
}
