/* Events that come too often are counted and reported with their number. */
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "firmware/door/door_events.h"

enum { BURST = ISO_EVENT_LIMIT_BURST };

static const int64_t ms_ns = ISO_NS_PER_MS;

static void a_few_events_pass(void **state)
{
    struct iso_event_limit limit = {.passed = 0};
    struct iso_event_report report;
    (void)state;
    for (int second = 0; second < 10; second++) {
        for (int i = 0; i < BURST; i++) {
            const int64_t now_ns = (second * 1000 + i * 10) * ms_ns;
            assert_false(iso_event_limit_report(&limit, false, now_ns, &report));
            assert_true(iso_event_limit_take(&limit, now_ns));
        }
    }
    assert_int_equal(iso_event_limit_due_ns(&limit), ISO_NEVER_NS);
    assert_false(iso_event_limit_report(&limit, true, 11000 * ms_ns, &report));
}

/* Of 200 events in a second, each one either passes or is counted. */
static void many_events_are_counted(void **state)
{
    struct iso_event_limit limit = {.passed = 0};
    struct iso_event_report report;
    int passed = 0;
    (void)state;
    for (int i = 0; i < 200; i++) {
        assert_false(iso_event_limit_report(&limit, false, i * 5 * ms_ns, &report));
        passed += iso_event_limit_take(&limit, i * 5 * ms_ns);
    }
    assert_int_equal(passed, BURST);
    assert_int_equal(iso_event_limit_due_ns(&limit), (995 + 1000) * ms_ns);
    assert_false(iso_event_limit_report(&limit, false, 1994 * ms_ns, &report));
    assert_true(iso_event_limit_report(&limit, false, 1995 * ms_ns, &report));
    assert_int_equal(report.events, 200 - BURST);
    assert_int_equal(report.length_ns, (995 - 5 * BURST) * ms_ns);
    assert_true(iso_event_limit_take(&limit, 1995 * ms_ns)); /* the limit is over */
}

static void lasting_events_are_reported_every_ten_seconds(void **state)
{
    struct iso_event_limit limit = {.passed = 0};
    struct iso_event_report report;
    uint64_t events = 0, passed = 0, reports = 0;
    (void)state;
    for (int64_t i = 0; i < 60 * 100; i++) {
        if (iso_event_limit_report(&limit, false, i * 10 * ms_ns, &report)) {
            events += report.events;
            reports++;
        }
        passed += iso_event_limit_take(&limit, i * 10 * ms_ns);
    }
    assert_int_equal(passed, BURST);
    assert_int_equal(reports, 5);
    assert_true(iso_event_limit_report(&limit, true, 60000 * ms_ns, &report));
    assert_int_equal(passed + events + report.events, 6000);
    assert_false(iso_event_limit_report(&limit, true, 60000 * ms_ns, &report));
}

/* ---- of the door ---- */

static struct iso_door_news news_of(enum iso_door_event cause, enum iso_door_state state)
{
    return (struct iso_door_news){.cause = cause, .state = state};
}

/* A contact that chatters does not hide events of another kind. */
static void each_input_is_limited_for_itself(void **state)
{
    struct iso_door_events events = {.newest = {.tamper = false}};
    struct iso_door_burst burst;
    const struct iso_door_news opened = news_of(ISO_DOOR_ON_OPENED, ISO_DOOR_FORCED);
    const struct iso_door_news tamper = news_of(ISO_DOOR_ON_TAMPER, ISO_DOOR_FORCED);
    const struct iso_door_news granted = news_of(ISO_DOOR_ON_GRANT, ISO_DOOR_UNLOCKED);
    int passed = 0;
    (void)state;
    for (int i = 0; i < 50; i++) {
        passed += iso_door_events_take(&events, &opened, i * 10 * ms_ns);
        assert_true(iso_door_events_take(&events, &granted, i * 10 * ms_ns));
    }
    assert_int_equal(passed, BURST);
    assert_true(iso_door_events_take(&events, &tamper, 500 * ms_ns));
    assert_int_equal(iso_door_events_due_ns(&events), 1490 * ms_ns);
    assert_false(iso_door_events_next(&events, false, 1489 * ms_ns, &burst));
    assert_true(iso_door_events_next(&events, false, 1490 * ms_ns, &burst));
    assert_string_equal(burst.text, "contact changed 45 times in 0.4 s; now forced");
    assert_int_equal(burst.cause, ISO_DOOR_ON_OPENED);
    assert_int_equal(burst.state, ISO_DOOR_FORCED);
    assert_false(iso_door_events_next(&events, true, 1490 * ms_ns, &burst));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_few_events_pass),
        cmocka_unit_test(many_events_are_counted),
        cmocka_unit_test(lasting_events_are_reported_every_ten_seconds),
        cmocka_unit_test(each_input_is_limited_for_itself),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
