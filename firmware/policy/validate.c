#include "firmware/policy/validate.h"

#include <errno.h>
#include <string.h>

#include "core/base/fault.h"
#include "firmware/policy/validate_parts.h"

int iso__validate_token(const char *kind, uint32_t number, const char token[ISO_TOKEN_SIZE],
                        struct iso_fault *fault)
{
    if (token[0] == '\0') {
        return iso_fault_set(fault, -EINVAL, "%s number %lu: has no token", kind,
                             (unsigned long)number);
    }
    if (!memchr(token, '\0', ISO_TOKEN_SIZE)) {
        return iso_fault_set(fault, -EINVAL, "%s number %lu: the token has more than %d bytes",
                             kind, (unsigned long)number, ISO_TOKEN_SIZE - 1);
    }
    return 0;
}

int iso__validate_index(const struct iso__record *record, const char *what, uint32_t index,
                        uint32_t n)
{
    return index < n ? 0
                     : iso_fault_set(record->fault, -EINVAL,
                                     "%s \"%s\": names %s %lu, and there are %lu", record->kind,
                                     record->token, what, (unsigned long)index, (unsigned long)n);
}

int iso__validate_count(const struct iso__record *record, const char *what, unsigned n,
                        unsigned max)
{
    return n <= max ? 0
                    : iso_fault_set(record->fault, -EINVAL, "%s \"%s\": has %u %s, at most %u",
                                    record->kind, record->token, n, what, max);
}

static int wrong(const struct iso__record *record, const char *flaw)
{
    return iso_fault_set(record->fault, -EINVAL, "%s \"%s\": %s", record->kind, record->token,
                         flaw);
}

static int validate_areas(const struct iso_policy *policy, struct iso_fault *fault)
{
    int error = 0;
    for (uint16_t i = 0; error == 0 && i < policy->n_areas; i++) {
        error = iso__validate_token("area", i, policy->areas[i].token, fault);
    }
    return error;
}

static int validate_level(const struct iso_policy *policy, uint16_t at,
                          const struct iso__record *record)
{
    const struct iso_security_level *level = &policy->levels[at];
    const int error = iso__validate_count(record, "groups", level->n_groups,
                                          ISO_RECOGNITION_GROUPS_MAX);
    if (error != 0) {
        return error;
    }
    if (level->open && level->n_groups != 0) {
        return wrong(record, "is open and has recognition groups");
    }
    for (int i = 0; i < level->n_groups; i++) {
        if (level->groups[i] == 0) {
            return wrong(record, "has a recognition group without methods");
        }
        if ((level->groups[i] & ~ISO_RECOGNITION_ALL) != 0) {
            return wrong(record, "has a recognition method that does not exist");
        }
    }
    for (uint16_t i = 0; i < at; i++) {
        if (policy->levels[i].priority == level->priority) {
            return iso_fault_set(record->fault, -EINVAL,
                                 "%s \"%s\": has the same priority as \"%s\"", record->kind,
                                 record->token, policy->levels[i].token);
        }
    }
    return 0;
}

static int validate_levels(const struct iso_policy *policy, struct iso_fault *fault)
{
    int error = 0;
    for (uint16_t i = 0; error == 0 && i < policy->n_levels; i++) {
        const struct iso__record record = {"security level", policy->levels[i].token, fault};
        error = iso__validate_token(record.kind, i, record.token, fault);
        error = error != 0 ? error : validate_level(policy, i, &record);
    }
    return error;
}

static int validate_authentication_policy(const struct iso_policy *policy,
                                          const struct iso_authentication_policy *part,
                                          const struct iso__record *record)
{
    int error = iso__validate_index(record, "schedule", part->schedule, policy->n_schedules);
    for (int s = 0; error == 0 && s < ISO_SCHEDULE_STATES; s++) {
        if (part->constraints[s].level != ISO_INDEX_NONE) {
            error = iso__validate_index(record, "security level", part->constraints[s].level,
                                        policy->n_levels);
        }
    }
    return error;
}

static int validate_authentication_profiles(const struct iso_policy *policy,
                                            struct iso_fault *fault)
{
    int error = 0;
    for (uint16_t i = 0; error == 0 && i < policy->n_authentication_profiles; i++) {
        const struct iso_authentication_profile *profile = &policy->authentication_profiles[i];
        const struct iso__record record = {"authentication profile", profile->token, fault};
        error = iso__validate_token(record.kind, i, record.token, fault);
        error = error != 0 ? error
                           : iso__validate_index(&record, "security level", profile->default_level,
                                                 policy->n_levels);
        error = error != 0 ? error
                           : iso__validate_count(&record, "policies", profile->n_policies,
                                                 ISO_AUTHENTICATION_POLICIES_MAX);
        for (int p = 0; error == 0 && p < profile->n_policies; p++) {
            error = validate_authentication_policy(policy, &profile->policies[p], &record);
        }
    }
    return error;
}

static int validate_antipassback(const struct iso_access_point *point,
                                 const struct iso__record *record)
{
    if (point->antipassback > ISO_ANTIPASSBACK_TIMED) {
        return wrong(record, "has a kind of antipassback that does not exist");
    }
    if (point->antipassback != ISO_ANTIPASSBACK_NONE && point->to == ISO_INDEX_NONE) {
        return wrong(record, "has antipassback and leads to no area");
    }
    if (point->antipassback == ISO_ANTIPASSBACK_TIMED ? point->antipassback_s < 1
                                                      : point->antipassback_s != 0) {
        return wrong(record, "has a time of antipassback that does not fit its kind");
    }
    if (point->from != ISO_INDEX_NONE && point->from == point->to) {
        return wrong(record, "leads from an area to the same one");
    }
    return 0;
}

static int validate_access_points(const struct iso_policy *policy, struct iso_fault *fault)
{
    int error = 0;
    for (uint16_t i = 0; error == 0 && i < policy->n_access_points; i++) {
        const struct iso_access_point *point = &policy->access_points[i];
        const struct iso__record record = {"access point", point->token, fault};
        error = iso__validate_token(record.kind, i, record.token, fault);
        if (error == 0 && point->from != ISO_INDEX_NONE) {
            error = iso__validate_index(&record, "area", point->from, policy->n_areas);
        }
        if (error == 0 && point->to != ISO_INDEX_NONE) {
            error = iso__validate_index(&record, "area", point->to, policy->n_areas);
        }
        error = error != 0 ? error
                           : iso__validate_index(&record, "authentication profile",
                                                 point->authentication_profile,
                                                 policy->n_authentication_profiles);
        error = error != 0 ? error : validate_antipassback(point, &record);
    }
    return error;
}

static int validate_access_profiles(const struct iso_policy *policy, struct iso_fault *fault)
{
    int error = 0;
    for (uint16_t i = 0; error == 0 && i < policy->n_access_profiles; i++) {
        const struct iso_access_profile *profile = &policy->access_profiles[i];
        const struct iso__record record = {"access profile", profile->token, fault};
        error = iso__validate_token(record.kind, i, record.token, fault);
        error = error != 0 ? error
                           : iso__validate_count(&record, "access policies", profile->n_policies,
                                                 ISO_ACCESS_POLICIES_MAX);
        for (int p = 0; error == 0 && p < profile->n_policies; p++) {
            error = iso__validate_index(&record, "access point", profile->policies[p].access_point,
                                        policy->n_access_points);
            error = error != 0
                        ? error
                        : iso__validate_index(&record, "schedule", profile->policies[p].schedule,
                                              policy->n_schedules);
        }
    }
    return error;
}

int iso_policy_validate(const struct iso_policy *policy, struct iso_fault *fault)
{
    static int (*const parts[])(const struct iso_policy *, struct iso_fault *) = {
        iso__validate_times,      validate_areas,
        validate_levels,          validate_authentication_profiles,
        validate_access_points,   validate_access_profiles,
        iso__validate_credentials};
    int error = 0;
    for (size_t i = 0; error == 0 && i < sizeof parts / sizeof *parts; i++) {
        error = parts[i](policy, fault);
    }
    return error;
}
