#include "tests/firmware/policy/reference.h"

#include <string.h>
#include <time.h>

/* ---- Schedule specification */

struct local {
    int64_t date_s; /* midnight of the date, as if it were UTC */
    int wday, minute;
};

static struct local local_time(const struct iso_policy *policy, int zone, int64_t time_s)
{
    struct tm fields;
    if (zone == 0) {
        const time_t t = (time_t)time_s;
        (void)localtime_r(&t, &fields);
    } else {
        const time_t t = (time_t)(time_s + policy->zones[zone].rule.standard_s);
        (void)gmtime_r(&t, &fields);
    }
    struct tm midnight = {
        .tm_year = fields.tm_year, .tm_mon = fields.tm_mon, .tm_mday = fields.tm_mday};
    return (struct local){.date_s = timegm(&midnight),
                          .wday = fields.tm_wday,
                          .minute = fields.tm_hour * 60 + fields.tm_min};
}

static bool hours_cover(const struct iso_day_hours *hours, int minute)
{
    bool covered = false;
    for (int i = 0; i < hours->n; i++) {
        covered = covered ||
                  !(minute < hours->periods[i].from_min || minute >= hours->periods[i].to_min);
    }
    return covered;
}

/* "Active" and "SpecialDay" of ONVIF's ScheduleState. */
static void schedule_state(const struct iso_policy *policy, int schedule, int64_t time_s,
                           bool *active, bool *special_day)
{
    const struct iso_schedule *s = &policy->schedules[schedule];
    const struct local now = local_time(policy, s->zone, time_s);
    *special_day = false;
    *active = false;
    for (int i = 0; i < s->n_special; i++) {
        const struct iso_special_day_group *group = &policy->groups[s->special[i].group];
        for (int d = 0; d < group->n; d++) {
            if ((int64_t)group->days[d] * 24 * 60 * 60 == now.date_s) {
                *special_day = true;
                *active = *active || hours_cover(&s->special[i].hours, now.minute);
            }
        }
    }
    if (!*special_day) {
        *active = hours_cover(&s->weekly[now.wday], now.minute);
    }
}

/* ---- Authentication Behavior specification: "walked through in priority order" */

static uint16_t level_at(const struct iso_policy *policy, const struct iso_access_point *point,
                         int64_t time_s, bool *dual)
{
    const struct iso_authentication_profile *profile =
        &policy->authentication_profiles[point->authentication_profile];
    bool asked[256] = {false}, asked_dual[256] = {false};
    for (int i = 0; i < profile->n_policies; i++) {
        bool active, special;
        schedule_state(policy, profile->policies[i].schedule, time_s, &active, &special);
        for (int s = 0; s < ISO_SCHEDULE_STATES; s++) {
            const struct iso_level_constraint *c = &profile->policies[i].constraints[s];
            if (((s & 1) != 0) == active && ((s & 2) != 0) == special &&
                c->level != ISO_INDEX_NONE) {
                asked[c->level] = true;
                asked_dual[c->level] = asked_dual[c->level] || c->dual;
            }
        }
    }
    int best = -1;
    for (int level = 0; level < policy->n_levels; level++) {
        if (asked[level] &&
            (best < 0 || policy->levels[level].priority > policy->levels[best].priority)) {
            best = level;
        }
    }
    *dual = best >= 0 && asked_dual[best];
    return best >= 0 ? (uint16_t)best : profile->default_level;
}

/* Whether having shown these methods completes a group. */
static bool completes(const struct iso_security_level *level, int shown)
{
    for (int i = 0; i < level->n_groups; i++) {
        bool all = level->groups[i] != 0;
        for (int method = 1; method <= ISO_RECOGNITION_PIN; method *= 2) {
            all = all && (!(level->groups[i] & method) || (shown & method));
        }
        if (all) {
            return true;
        }
    }
    return false;
}

/* ---- one person */

/* What is true of one person at one door; each fact is found without regard to the others. */
struct facts {
    bool known, enabled, begun, ended, named, permitted, differs, wrong_pin, can_pass, passes,
        violates;
};

static bool wrong_pin(const struct iso_credential *c, iso_pin pin)
{
    if (pin == 0) {
        return false;
    }
    const bool right = pin == c->pin || (c->duress_pin != 0 && pin == c->duress_pin);
    return !right || !(c->identifiers & ISO_RECOGNITION_PIN);
}

static int shown_methods(const struct iso_credential *c, const struct iso_shown *shown)
{
    int methods = 0;
    if (shown->matched & ISO_RECOGNITION_FACE) {
        methods += ISO_RECOGNITION_FACE;
    }
    if (shown->matched & ISO_RECOGNITION_CARD) {
        methods += ISO_RECOGNITION_CARD;
    }
    if (shown->pin != 0 && !wrong_pin(c, shown->pin)) {
        methods += ISO_RECOGNITION_PIN;
    }
    return methods;
}

static bool violates(const struct iso_access_point *point, const struct iso_credential *c,
                     const struct iso_presence *at, int64_t time_s)
{
    if (c->no_antipassback || !at || !at->known) {
        return false;
    }
    const bool is_there = at->area == point->to;
    switch (point->antipassback) {
    case ISO_ANTIPASSBACK_TIMED:
        return is_there && time_s < at->since_s + point->antipassback_s;
    case ISO_ANTIPASSBACK_SOFT:
    case ISO_ANTIPASSBACK_HARD:
        return point->from == ISO_INDEX_NONE ? is_there : at->area != point->from;
    default:
        return false;
    }
}

static struct facts find_facts(const struct iso_policy *policy,
                               const struct iso_occupancy *occupancy, uint16_t access_point,
                               uint16_t level, uint32_t credential, const struct iso_shown *shown,
                               int64_t time_s)
{
    struct facts facts = {.known = credential < policy->n_credentials};
    if (!facts.known) {
        return facts;
    }
    const struct iso_credential *c = &policy->credentials[credential];
    facts.enabled = c->enabled;
    facts.begun = c->valid_from_s == 0 || c->valid_from_s <= time_s;
    facts.ended = c->valid_to_s != 0 && c->valid_to_s <= time_s;
    for (int i = 0; i < c->n_profiles; i++) {
        const struct iso_access_profile *profile = &policy->access_profiles[c->profiles[i]];
        for (int p = 0; p < profile->n_policies; p++) {
            bool active, special;
            schedule_state(policy, profile->policies[p].schedule, time_s, &active, &special);
            const bool here = profile->policies[p].access_point == access_point;
            facts.named = facts.named || here;
            facts.permitted = facts.permitted || (here && active);
        }
    }
    facts.differs = shown->differed != 0 || (shown->matched & ~(unsigned)c->identifiers) != 0;
    facts.wrong_pin = wrong_pin(c, shown->pin);
    facts.can_pass = completes(&policy->levels[level], c->identifiers);
    facts.passes = completes(&policy->levels[level], shown_methods(c, shown));
    facts.violates = violates(&policy->access_points[access_point], c,
                              credential < occupancy->n ? &occupancy->presences[credential] : NULL,
                              time_s);
    return facts;
}

/* The list of the picture in policy.h. Returns whether the person passes; if not, *access says why.
 */
static bool judge(const struct facts *facts, const struct iso_security_level *level, int mode,
                  struct iso_access *access)
{
    const bool closed = !completes(level, ISO_RECOGNITION_ALL);
    const struct {
        bool refuses;
        enum iso_access_reason reason;
    } list[] = {
        {!facts->known, ISO_ACCESS_NOT_FOUND},
        {!facts->enabled, ISO_ACCESS_NOT_ENABLED},
        {!facts->begun, ISO_ACCESS_NOT_ACTIVE},
        {facts->ended, ISO_ACCESS_EXPIRED},
        {!facts->named, ISO_ACCESS_UNAUTHORIZED},
        {!facts->permitted || closed, ISO_ACCESS_NOT_AT_THIS_TIME},
        {facts->differs, ISO_ACCESS_INVALID_IDENTIFIER},
        {facts->wrong_pin, ISO_ACCESS_INVALID_PIN},
        {!facts->can_pass, ISO_ACCESS_UNAUTHORIZED},
        {facts->passes && facts->violates && mode != ISO_ANTIPASSBACK_SOFT,
         ISO_ACCESS_ANTIPASSBACK},
    };
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        if (list[i].refuses) {
            access->outcome = ISO_ACCESS_DENY;
            access->reason = list[i].reason;
            return false;
        }
    }
    access->outcome = facts->passes ? ISO_ACCESS_ALLOW : ISO_ACCESS_WANT;
    return facts->passes;
}

static bool entered_duress(const struct iso_policy *policy, uint32_t credential,
                           const struct iso_shown *shown)
{
    return credential < policy->n_credentials && shown->pin != 0 &&
           shown->pin == policy->credentials[credential].duress_pin;
}

/* ---- two people */

struct iso_access reference_decide(const struct iso_policy *policy,
                                   const struct iso_occupancy *occupancy,
                                   const struct iso_access_request *request)
{
    struct iso_access access = {0};
    access.duress = entered_duress(policy, request->credential, &request->shown) ||
                    entered_duress(policy, request->companion, &request->companion_shown);
    const uint16_t door = request->access_point;
    if (door >= policy->n_access_points || !policy->access_points[door].enabled) {
        return access;
    }
    const struct iso_access_point *point = &policy->access_points[door];
    bool dual;
    const uint16_t level = level_at(policy, point, request->time_s, &dual);
    access.has_level = true;
    access.level = level;
    if (policy->levels[level].open) {
        access.outcome = ISO_ACCESS_ALLOW;
        return access;
    }
    const struct facts first = find_facts(policy, occupancy, door, level, request->credential,
                                          &request->shown, request->time_s);
    if (!judge(&first, &policy->levels[level], point->antipassback, &access)) {
        return access;
    }
    const bool soft = point->antipassback == ISO_ANTIPASSBACK_SOFT;
    const struct iso_credential *a = &policy->credentials[request->credential];
    if (!dual && !a->needs_escort) {
        access.passback = soft && first.violates;
        return access;
    }
    if (request->companion == ISO_CREDENTIAL_NONE || request->companion == request->credential) {
        access.outcome = ISO_ACCESS_WANT;
        access.companion_wanted = true;
        return access;
    }
    const struct facts second = find_facts(policy, occupancy, door, level, request->companion,
                                           &request->companion_shown, request->time_s);
    if (!judge(&second, &policy->levels[level], point->antipassback, &access)) {
        access.of_companion = true;
        return access;
    }
    const struct iso_credential *b = &policy->credentials[request->companion];
    const bool same_class = a->two_person_class == b->two_person_class && a->two_person_class != 0;
    if ((dual && same_class) || (a->needs_escort && b->needs_escort)) {
        access.outcome = ISO_ACCESS_DENY;
        access.reason = ISO_ACCESS_NO_PAIR;
        return access;
    }
    access.passback = soft && first.violates;
    access.companion_passback = soft && second.violates;
    return access;
}

bool reference_wanted_is_right(const struct iso_policy *policy, uint16_t level, uint32_t credential,
                               const struct iso_shown *shown, uint8_t wanted)
{
    const struct iso_credential *c = &policy->credentials[credential];
    const struct iso_security_level *l = &policy->levels[level];
    const int has = shown_methods(c, shown);
    int smallest = 99;
    for (int more = 1; more <= ISO_RECOGNITION_ALL; more++) {
        const int bits = __builtin_popcount((unsigned)more);
        if ((more & ~c->identifiers) == 0 && completes(l, has | more) && bits < smallest) {
            smallest = bits;
        }
    }
    return wanted != 0 && (wanted & has) == 0 && (wanted & ~c->identifiers) == 0 &&
           completes(l, has | wanted) && __builtin_popcount(wanted) == smallest;
}
