#include "tests/enroll/web/rigs/story_rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>

#include "firmware/contract/contract.h"

void rig_story_begin(struct rig_story *story, struct rig *rig)
{
    *story = (struct rig_story){.rig = rig, .session = rig_session(rig)};
    story->events = rig_exchange(WEB_ROLE_ENROLLER, story->session, NULL);
    web_api_get_events(&rig->api, &story->events);
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ENROLLER, story->session, RIG_REQUEST);
    web_api_begin_enrolment(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, 201, NULL);
    assert_string_equal(json_string_value(json_object_get(exchange.json, "state")), "running");
    assert_true(json_is_true(json_object_get(exchange.json, "own")));
    rig_exchange_done(&exchange);
    assert_string_equal(rig->service.trace, RIG_CALLS);
}

bool rig_is_idle(void *rig)
{
    return !web_enrolment_is_busy(((struct rig *)rig)->api.enrolment);
}

json_t *rig_story_end(struct rig_story *story, const char *result)
{
    struct rig *rig = story->rig;
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ENROLLER, story->session, NULL);
    rig_wait(rig->event, rig_is_idle, rig, "the end of the enrolment");
    web_api_get_enrolment(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, 200, NULL);
    json_t *enrolment = json_incref(exchange.json);
    rig_exchange_done(&exchange);
    assert_string_equal(json_string_value(json_object_get(enrolment, "state")), "ended");
    assert_string_equal(json_string_value(json_object_get(enrolment, "result")), result);
    if (story->events.stream) {
        rig_expect_text(rig->event, story->events.stream, "\"state\":\"ended\"");
        rig_close(&story->events);
    }
    rig_exchange_done(&story->events);
    return enrolment;
}

bool rig_has_released(const struct rig *rig)
{
    const char *trace = rig->service.trace;
    return strlen(trace) >= 8 && strcmp(trace + strlen(trace) - 8, "Release;") == 0;
}

void rig_send_status(struct rig *rig, const char *result, bool done, unsigned stage, double quality,
                     const char *person)
{
    rig_service_signal(&rig->service, true, ISO_CONTRACT_ENROLL_STATUS, "sbuuds", result, (int)done,
                       stage, 12U, quality, person);
}

void rig_send_step(struct rig *rig, const char *pose, const char *state, unsigned step,
                   double turn_deg)
{
    rig_service_signal(&rig->service, true, ISO_CONTRACT_ENROLL_STEP, "ssuud", pose, state, step,
                       5U, turn_deg);
}
