#include "firmware/policy/decide_person.h"

#include "firmware/policy/schedule.h"

static struct iso__person_answer deny(enum iso_access_reason reason)
{
    return (struct iso__person_answer){.outcome = ISO_ACCESS_DENY, .reason = reason};
}

/* How the access policies of a person answer. */
enum permission { NOWHERE, NOT_NOW, NOW };

static enum permission profile_permits(const struct iso__person_case *person,
                                       const struct iso_access_profile *profile)
{
    enum permission best = NOWHERE;
    for (int i = 0; i < profile->n_policies; i++) {
        const struct iso_access_policy *p = &profile->policies[i];
        if (p->access_point != person->access_point) {
            continue;
        }
        best = NOT_NOW;
        if (iso_schedule_state_is_active(iso_schedule_state_at(
                person->policy, &person->policy->schedules[p->schedule], person->time_s))) {
            return NOW;
        }
    }
    return best;
}

static enum permission permits(const struct iso__person_case *person,
                               const struct iso_credential *credential)
{
    enum permission best = NOWHERE;
    for (int i = 0; i < credential->n_profiles && best != NOW; i++) {
        const enum permission p = profile_permits(
            person, &person->policy->access_profiles[credential->profiles[i]]);
        best = p > best ? p : best;
    }
    return best;
}

static int count_bits(uint8_t bits)
{
    return __builtin_popcount(bits);
}

bool iso_security_level_can_pass(const struct iso_security_level *level, uint8_t identifiers)
{
    if (level->open) {
        return true;
    }
    for (int i = 0; i < level->n_groups; i++) {
        if (level->groups[i] != 0 && (level->groups[i] & ~identifiers) == 0) {
            return true;
        }
    }
    return false;
}

/* A closed level: nobody could pass it with anything. */
static bool is_closed(const struct iso_security_level *level)
{
    return !iso_security_level_can_pass(level, ISO_RECOGNITION_ALL);
}

/* What is missing to pass the level, as the smallest rest of a group; 0: nothing. */
static struct iso__person_answer authenticate(const struct iso_security_level *level,
                                              const struct iso_credential *credential,
                                              uint8_t shown)
{
    if (!iso_security_level_can_pass(level, credential->identifiers)) {
        return deny(ISO_ACCESS_UNAUTHORIZED);
    }
    int fewest = 8;
    uint8_t wanted = 0;
    for (int i = 0; i < level->n_groups; i++) {
        const uint8_t group = level->groups[i];
        const uint8_t missing = (uint8_t)(group & ~shown);
        if (group != 0 && (group & ~credential->identifiers) == 0 && count_bits(missing) < fewest) {
            fewest = count_bits(missing);
            wanted = missing;
        }
    }
    return (struct iso__person_answer){.outcome = wanted == 0 ? ISO_ACCESS_ALLOW : ISO_ACCESS_WANT,
                                       .wanted = wanted};
}

/* Whether what was shown agrees with the credential; *shown becomes what counts as shown. */
static enum iso_access_reason compare_shown(const struct iso_credential *credential,
                                            const struct iso_shown *seen, uint8_t *shown)
{
    if (seen->differed != 0 || (seen->matched & ~credential->identifiers) != 0) {
        return ISO_ACCESS_INVALID_IDENTIFIER;
    }
    *shown = seen->matched & (uint8_t)~ISO_RECOGNITION_PIN;
    if (seen->pin == 0) {
        return ISO_ACCESS_OTHER;
    }
    if ((credential->identifiers & ISO_RECOGNITION_PIN) == 0 ||
        (seen->pin != credential->pin && seen->pin != credential->duress_pin)) {
        return ISO_ACCESS_INVALID_PIN;
    }
    *shown |= ISO_RECOGNITION_PIN;
    return ISO_ACCESS_OTHER;
}

/* Whether entering violates the antipassback of the access point. */
static bool violates(const struct iso__person_case *person)
{
    const struct iso_access_point *point = &person->policy->access_points[person->access_point];
    if (point->antipassback == ISO_ANTIPASSBACK_NONE ||
        person->policy->credentials[person->credential].no_antipassback ||
        person->credential >= person->occupancy->n) {
        return false;
    }
    const struct iso_presence *presence = &person->occupancy->presences[person->credential];
    if (!presence->known) {
        return false;
    }
    if (point->antipassback == ISO_ANTIPASSBACK_TIMED) {
        return presence->area == point->to &&
               person->time_s - presence->since_s < point->antipassback_s;
    }
    return point->from != ISO_INDEX_NONE ? presence->area != point->from
                                         : presence->area == point->to;
}

static enum iso_access_reason admit(const struct iso__person_case *person,
                                    const struct iso_credential *credential)
{
    if (!credential->enabled) {
        return ISO_ACCESS_NOT_ENABLED;
    }
    if (credential->valid_from_s != 0 && person->time_s < credential->valid_from_s) {
        return ISO_ACCESS_NOT_ACTIVE;
    }
    if (credential->valid_to_s != 0 && person->time_s >= credential->valid_to_s) {
        return ISO_ACCESS_EXPIRED;
    }
    const enum permission permission = permits(person, credential);
    if (permission == NOWHERE) {
        return ISO_ACCESS_UNAUTHORIZED;
    }
    return permission == NOT_NOW || is_closed(person->level) ? ISO_ACCESS_NOT_AT_THIS_TIME
                                                             : ISO_ACCESS_OTHER;
}

struct iso__person_answer iso__person_decide(const struct iso__person_case *person)
{
    if (person->credential >= person->policy->n_credentials) {
        return deny(ISO_ACCESS_NOT_FOUND);
    }
    const struct iso_credential *credential = &person->policy->credentials[person->credential];
    uint8_t shown = 0;
    enum iso_access_reason reason = admit(person, credential);
    if (reason == ISO_ACCESS_OTHER) {
        reason = compare_shown(credential, person->shown, &shown);
    }
    if (reason != ISO_ACCESS_OTHER) {
        return deny(reason);
    }
    struct iso__person_answer answer = authenticate(person->level, credential, shown);
    if (answer.outcome == ISO_ACCESS_ALLOW && violates(person)) {
        const uint8_t mode = person->policy->access_points[person->access_point].antipassback;
        if (mode != ISO_ANTIPASSBACK_SOFT) {
            return deny(ISO_ACCESS_ANTIPASSBACK);
        }
        answer.passback = true;
    }
    return answer;
}
