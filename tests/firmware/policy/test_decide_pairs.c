/* Every rule alone, and every two rules at once: the earlier one of the documented order decides.
 */
#include <stdio.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/policy/validate.h"
#include "tests/firmware/policy/policy_rig.h"

typedef void breaks(struct policy_rig *rig, struct iso_access_request *request);

static void out_of_service(struct policy_rig *rig, struct iso_access_request *request)
{
    rig->access_points[request->access_point].enabled = false;
}

static void open_level(struct policy_rig *rig, struct iso_access_request *request)
{
    (void)request;
    policy_rig_ask(rig, RIG_ALWAYS, RIG_OPEN, false);
}

static void unknown(struct policy_rig *rig, struct iso_access_request *request)
{
    (void)rig;
    request->credential = ISO_CREDENTIAL_NONE;
}

static void disabled(struct policy_rig *rig, struct iso_access_request *request)
{
    (void)request;
    rig->credentials[RIG_ANNA].enabled = false;
}

static void too_early(struct policy_rig *rig, struct iso_access_request *request)
{
    rig->credentials[RIG_ANNA].valid_from_s = request->time_s + 1;
}

static void expired(struct policy_rig *rig, struct iso_access_request *request)
{
    rig->credentials[RIG_ANNA].valid_to_s = request->time_s;
}

static void no_access_policy(struct policy_rig *rig, struct iso_access_request *request)
{
    (void)request;
    rig->credentials[RIG_ANNA].n_profiles = 0;
}

static void not_now(struct policy_rig *rig, struct iso_access_request *request)
{
    rig->access_profiles[RIG_STAFF].policies[request->access_point].schedule = RIG_NEVER;
}

static void closed_level(struct policy_rig *rig, struct iso_access_request *request)
{
    (void)request;
    policy_rig_ask(rig, RIG_ALWAYS, RIG_CLOSED, false);
}

static void other_card(struct policy_rig *rig, struct iso_access_request *request)
{
    (void)rig;
    request->shown.differed = ISO_RECOGNITION_CARD;
}

static void wrong_pin(struct policy_rig *rig, struct iso_access_request *request)
{
    (void)rig;
    request->shown.pin = RIG_PIN + 5;
}

static void no_face(struct policy_rig *rig, struct iso_access_request *request)
{
    rig->credentials[RIG_ANNA].identifiers = ISO_RECOGNITION_CARD | ISO_RECOGNITION_PIN;
    request->shown.matched = ISO_RECOGNITION_CARD;
}

static void nothing_shown(struct policy_rig *rig, struct iso_access_request *request)
{
    (void)rig;
    request->shown.matched = 0;
}

static void passback(struct policy_rig *rig, struct iso_access_request *request)
{
    rig->access_points[request->access_point].antipassback = ISO_ANTIPASSBACK_HARD;
    rig->presences[RIG_ANNA] = (struct iso_presence){.known = true, .area = RIG_LAB};
}

static void escort_missing(struct policy_rig *rig, struct iso_access_request *request)
{
    rig->credentials[RIG_ANNA].needs_escort = true;
    request->companion = ISO_CREDENTIAL_NONE;
}

static void second_missing(struct policy_rig *rig, struct iso_access_request *request)
{
    policy_rig_ask(rig, RIG_ALWAYS, RIG_FACE, true);
    request->companion = RIG_ANNA; /* the same person again is nobody */
}

static void with_ben(struct policy_rig *rig, struct iso_access_request *request)
{
    policy_rig_ask(rig, RIG_ALWAYS, RIG_FACE, true);
    request->companion = RIG_BEN;
    request->companion_shown.matched = ISO_RECOGNITION_FACE;
}

static void second_disabled(struct policy_rig *rig, struct iso_access_request *request)
{
    with_ben(rig, request);
    rig->credentials[RIG_BEN].enabled = false;
}

static void second_shows_nothing(struct policy_rig *rig, struct iso_access_request *request)
{
    with_ben(rig, request);
    request->companion_shown.matched = 0;
}

static void same_class(struct policy_rig *rig, struct iso_access_request *request)
{
    with_ben(rig, request);
    rig->credentials[RIG_ANNA].two_person_class = 3;
    rig->credentials[RIG_BEN].two_person_class = 3;
}

static void two_guests(struct policy_rig *rig, struct iso_access_request *request)
{
    with_ben(rig, request);
    rig->credentials[RIG_ANNA].needs_escort = true;
    rig->credentials[RIG_BEN].needs_escort = true;
}

#define DENY(r)                                   \
    {                                             \
        .outcome = ISO_ACCESS_DENY, .reason = (r) \
    }

/* In the order of the picture of policy.h. */
static const struct {
    const char *name;
    breaks *break_it;
    struct iso_access expected;
} rules[] = {
    {"out of service", out_of_service, DENY(ISO_ACCESS_OTHER)},
    {"open", open_level, {.outcome = ISO_ACCESS_ALLOW}},
    {"unknown", unknown, DENY(ISO_ACCESS_NOT_FOUND)},
    {"disabled", disabled, DENY(ISO_ACCESS_NOT_ENABLED)},
    {"too early", too_early, DENY(ISO_ACCESS_NOT_ACTIVE)},
    {"expired", expired, DENY(ISO_ACCESS_EXPIRED)},
    {"no access policy", no_access_policy, DENY(ISO_ACCESS_UNAUTHORIZED)},
    {"not now", not_now, DENY(ISO_ACCESS_NOT_AT_THIS_TIME)},
    {"closed", closed_level, DENY(ISO_ACCESS_NOT_AT_THIS_TIME)},
    {"other card", other_card, DENY(ISO_ACCESS_INVALID_IDENTIFIER)},
    {"wrong PIN", wrong_pin, DENY(ISO_ACCESS_INVALID_PIN)},
    {"no face", no_face, DENY(ISO_ACCESS_UNAUTHORIZED)},
    {"nothing shown", nothing_shown, {.outcome = ISO_ACCESS_WANT, .wanted = ISO_RECOGNITION_FACE}},
    {"passback", passback, DENY(ISO_ACCESS_ANTIPASSBACK)},
    {"escort missing", escort_missing, {.outcome = ISO_ACCESS_WANT, .companion_wanted = true}},
    {"second missing", second_missing, {.outcome = ISO_ACCESS_WANT, .companion_wanted = true}},
    {"second disabled", second_disabled, {.reason = ISO_ACCESS_NOT_ENABLED, .of_companion = true}},
    {"second shows nothing",
     second_shows_nothing,
     {.outcome = ISO_ACCESS_WANT, .wanted = ISO_RECOGNITION_FACE, .of_companion = true}},
    {"same class", same_class, DENY(ISO_ACCESS_NO_PAIR)},
    {"two guests", two_guests, DENY(ISO_ACCESS_NO_PAIR)},
};

enum { RULES = sizeof rules / sizeof *rules };

static bool is_same(const struct iso_access *a, const struct iso_access *b)
{
    return a->outcome == b->outcome && a->reason == b->reason && a->wanted == b->wanted &&
           a->companion_wanted == b->companion_wanted && a->of_companion == b->of_companion &&
           a->duress == b->duress && a->passback == b->passback &&
           a->companion_passback == b->companion_passback;
}

static void expect(const struct policy_rig *rig, const struct iso_access_request *request, int rule,
                   const char *what)
{
    const struct iso_access access = policy_rig_decide(rig, request);
    if (!is_same(&access, &rules[rule].expected)) {
        fail_msg("%s: outcome %d, reason %s, wanted %d; expected as \"%s\"", what, access.outcome,
                 iso_access_reason_name(access.reason), access.wanted, rules[rule].name);
    }
}

static void test_each_rule_alone(void **state)
{
    (void)state;
    for (int i = 0; i < RULES; i++) {
        struct policy_rig rig;
        policy_rig_init(&rig);
        struct iso_access_request request = policy_rig_request();
        assert_int_equal(policy_rig_decide(&rig, &request).outcome, ISO_ACCESS_ALLOW);
        rules[i].break_it(&rig, &request);
        struct iso_fault fault = {0};
        assert_int_equal(iso_policy_validate(&rig.policy, &fault), 0);
        expect(&rig, &request, i, rules[i].name);
    }
}

/* The later rule is broken first: where both set the same thing, the earlier rule stays broken. */
static void test_every_pair(void **state)
{
    (void)state;
    int n = 0;
    for (int i = 0; i < RULES; i++) {
        for (int k = i + 1; k < RULES; k++, n++) {
            struct policy_rig rig;
            policy_rig_init(&rig);
            struct iso_access_request request = policy_rig_request();
            rules[k].break_it(&rig, &request);
            rules[i].break_it(&rig, &request);
            char what[80];
            (void)snprintf(what, sizeof what, "%s and %s", rules[i].name, rules[k].name);
            expect(&rig, &request, i, what);
        }
    }
    assert_int_equal(n, RULES * (RULES - 1) / 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_each_rule_alone),
        cmocka_unit_test(test_every_pair),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
