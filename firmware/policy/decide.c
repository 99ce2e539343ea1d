#include "firmware/policy/decide.h"

#include "firmware/policy/decide_person.h"
#include "firmware/policy/schedule.h"

const char *iso_access_reason_name(enum iso_access_reason reason)
{
    static const char *const names[ISO_ACCESS_REASONS] = {
        [ISO_ACCESS_OTHER] = "Other",
        [ISO_ACCESS_NOT_FOUND] = "CredentialNotFound",
        [ISO_ACCESS_NOT_ENABLED] = "CredentialNotEnabled",
        [ISO_ACCESS_NOT_ACTIVE] = "CredentialNotActive",
        [ISO_ACCESS_EXPIRED] = "CredentialExpired",
        [ISO_ACCESS_UNAUTHORIZED] = "Unauthorized",
        [ISO_ACCESS_NOT_AT_THIS_TIME] = "NotPermittedAtThisTime",
        [ISO_ACCESS_INVALID_IDENTIFIER] = "pt:InvalidIdentifierValue",
        [ISO_ACCESS_INVALID_PIN] = "InvalidPIN",
        [ISO_ACCESS_ANTIPASSBACK] = "isotherm:AntipassbackViolation",
        [ISO_ACCESS_NO_PAIR] = "isotherm:NoPair",
        [ISO_ACCESS_NO_LEASE] = "isotherm:NoLease",
        [ISO_ACCESS_NOT_APPROVED] = "isotherm:NotApproved",
    };
    return reason < ISO_ACCESS_REASONS ? names[reason] : NULL;
}

struct iso_level_constraint iso_access_level_at(const struct iso_policy *policy,
                                                const struct iso_access_point *access_point,
                                                int64_t time_s)
{
    const struct iso_authentication_profile *profile =
        &policy->authentication_profiles[access_point->authentication_profile];
    struct iso_level_constraint strictest = {.level = ISO_INDEX_NONE};
    for (int i = 0; i < profile->n_policies; i++) {
        const struct iso_authentication_policy *p = &profile->policies[i];
        const struct iso_level_constraint *asked =
            &p->constraints[iso_schedule_state_at(policy, &policy->schedules[p->schedule], time_s)];
        if (asked->level == ISO_INDEX_NONE) {
            continue;
        }
        if (strictest.level == ISO_INDEX_NONE ||
            policy->levels[asked->level].priority > policy->levels[strictest.level].priority) {
            strictest = *asked;
        } else if (asked->level == strictest.level) {
            strictest.dual |= asked->dual; /* the same level twice: the stricter mode */
        }
    }
    return strictest.level != ISO_INDEX_NONE
               ? strictest
               : (struct iso_level_constraint){.level = profile->default_level};
}

/* Whether a PIN was entered that is this credential's duress PIN. */
static bool is_duress(const struct iso_policy *policy, uint32_t credential, iso_pin pin)
{
    return credential < policy->n_credentials && pin != 0 &&
           pin == policy->credentials[credential].duress_pin;
}

/* The second person, after the first one has passed. */
static void decide_companion(const struct iso__person_case *first,
                             const struct iso_access_request *request, bool dual,
                             struct iso_access *access)
{
    const struct iso_policy *policy = first->policy;
    const struct iso_credential *person = &policy->credentials[request->credential];
    const uint32_t companion = request->companion;
    if (companion == ISO_CREDENTIAL_NONE || companion == request->credential) {
        access->outcome = ISO_ACCESS_WANT;
        access->companion_wanted = true;
        return;
    }
    struct iso__person_case second = *first;
    second.credential = companion;
    second.shown = &request->companion_shown;
    const struct iso__person_answer answer = iso__person_decide(&second);
    if (answer.outcome != ISO_ACCESS_ALLOW) {
        access->outcome = answer.outcome;
        access->reason = answer.reason;
        access->wanted = answer.wanted;
        access->of_companion = true;
        return;
    }
    const struct iso_credential *other = &policy->credentials[companion];
    if ((person->needs_escort && other->needs_escort) ||
        (dual && person->two_person_class != 0 &&
         person->two_person_class == other->two_person_class)) {
        access->outcome = ISO_ACCESS_DENY;
        access->reason = ISO_ACCESS_NO_PAIR;
        return;
    }
    access->outcome = ISO_ACCESS_ALLOW;
    access->companion_passback = answer.passback;
}

struct iso_access iso_access_decide(const struct iso_policy *policy,
                                    const struct iso_occupancy *occupancy,
                                    const struct iso_access_request *request)
{
    struct iso_access access = {
        .duress = is_duress(policy, request->credential, request->shown.pin) ||
                  is_duress(policy, request->companion, request->companion_shown.pin)};
    if (request->access_point >= policy->n_access_points ||
        !policy->access_points[request->access_point].enabled) {
        return access;
    }
    const struct iso_access_point *point = &policy->access_points[request->access_point];
    const struct iso_level_constraint asked = iso_access_level_at(policy, point, request->time_s);
    access.has_level = true;
    access.level = asked.level;
    if (policy->levels[asked.level].open) {
        access.outcome = ISO_ACCESS_ALLOW;
        return access;
    }
    const struct iso__person_case first = {.policy = policy,
                                           .occupancy = occupancy,
                                           .access_point = request->access_point,
                                           .level = &policy->levels[asked.level],
                                           .credential = request->credential,
                                           .shown = &request->shown,
                                           .time_s = request->time_s};
    const struct iso__person_answer answer = iso__person_decide(&first);
    access.outcome = answer.outcome;
    access.reason = answer.reason;
    access.wanted = answer.wanted;
    access.passback = answer.passback;
    if (answer.outcome == ISO_ACCESS_ALLOW &&
        (asked.dual || policy->credentials[request->credential].needs_escort)) {
        decide_companion(&first, request, asked.dual, &access);
    }
    if (access.outcome != ISO_ACCESS_ALLOW) {
        access.passback = false;
    }
    return access;
}
