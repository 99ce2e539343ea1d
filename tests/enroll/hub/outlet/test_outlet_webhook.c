/* Webhooks against a real HTTPS server and a real PostgreSQL. The outlets run in a process of their
 * own, which is killed in some of the tests. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <jansson.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "enroll/hub/outlet/run/backoff.h"
#include "enroll/hub/outlet/run/hub_outlet_try.h"
#include "tests/enroll/hub/outlet/webhook_rig.h"
#include "tests/support/scratch.h"

static void events_arrive_signed_and_in_order(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id a = outlet_rig_door(rig, "A"), b = outlet_rig_door(rig, "B");
    outlet_rig_events(rig, &a, 1, 450, "visit");
    outlet_rig_events(rig, &b, 1, 3, "visit");
    webhook_rig_add(rig, NULL, true, webhook_rig_receiver.pair.certificate);
    const pid_t pid = outlet_rig_run(rig, WEBHOOK_RIG_LOG);
    outlet_rig_wait_idle(rig, "siem", 20);
    outlet_rig_events(rig, &b, 4, 5, "attack");
    outlet_rig_wait_idle(rig, "siem", 20);
    outlet_rig_end(pid);
    const struct arrivals arrivals = webhook_rig_arrivals();
    assert_int_equal(arrivals.n_doors, 2);
    assert_int_equal(arrivals.events, 455);
    assert_int_equal(arrivals.repeated_batches, 0);
    const struct hub_outlet outlet = outlet_rig_outlet(rig, "siem");
    assert_int_equal(outlet.delivered, 455);
    assert_false(outlet.in_flight);
    assert_string_equal(outlet.trouble, "");
}

static void an_outlet_begins_with_the_next_event_and_keeps_to_its_filter(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id a = outlet_rig_door(rig, "A");
    outlet_rig_events(rig, &a, 1, 10, "attack");
    webhook_rig_add(rig, "attack,duress", false, webhook_rig_receiver.pair.certificate);
    outlet_rig_events(rig, &a, 11, 20, "visit");
    outlet_rig_events(rig, &a, 21, 21, "duress");
    outlet_rig_events(rig, &a, 22, 22, "attack");
    outlet_rig_events(rig, &a, 23, 30, "visit");
    const pid_t pid = outlet_rig_run(rig, WEBHOOK_RIG_LOG);
    outlet_rig_wait_idle(rig, "siem", 20);
    outlet_rig_end(pid);
    assert_int_equal(webhook_rig_receiver.n, 1);
    json_t *array = json_loads(webhook_rig_receiver.requests[0].body, 0, NULL);
    assert_int_equal(json_array_size(array), 2);
    for (size_t i = 0; i < 2; i++) {
        assert_int_equal(json_integer_value(json_object_get(json_array_get(array, i), "number")),
                         21 + (json_int_t)i);
    }
    json_decref(array);
}

static void a_failing_receiver_is_asked_again_within_the_bounds(void **state)
{
    struct store_rig *rig = *state;
    const unsigned statuses[] = {500, 503, 502};
    const struct iso_fleet_id a = outlet_rig_door(rig, "A");
    receiver_answer(&webhook_rig_receiver, 3, statuses);
    outlet_rig_events(rig, &a, 1, 2, "visit");
    webhook_rig_add(rig, NULL, true, webhook_rig_receiver.pair.certificate);
    const pid_t pid = outlet_rig_run(rig, WEBHOOK_RIG_LOG);
    receiver_wait(&webhook_rig_receiver, 4, 30);
    outlet_rig_wait_idle(rig, "siem", 10);
    outlet_rig_end(pid);
    int64_t most_ms = HUB__BACKOFF_FIRST_MS;
    for (size_t i = 1; i < 4; i++) {
        const int64_t gap_ms = webhook_rig_receiver.requests[i].at_ms -
                               webhook_rig_receiver.requests[i - 1].at_ms;
        /* It looks again every half second, and this machine may be busy. */
        assert_in_range(gap_ms, most_ms / 2, most_ms + 1500);
        assert_string_equal(webhook_rig_receiver.requests[i].key,
                            webhook_rig_receiver.requests[0].key);
        most_ms *= 2;
    }
    assert_int_equal(webhook_rig_arrivals().events, 2);
    assert_int_equal(outlet_rig_outlet(rig, "siem").failures, 0);
    char *log = scratch_read_text(WEBHOOK_RIG_LOG);
    assert_non_null(strstr(log, "outlet siem: the receiver answers 500; failure 1"));
    assert_non_null(strstr(log, "outlet siem: it works again, after 3 failures"));
    free(log);
}

static void a_receiver_may_ask_for_time(void **state)
{
    struct store_rig *rig = *state;
    const unsigned statuses[] = {429};
    const struct iso_fleet_id a = outlet_rig_door(rig, "A");
    receiver_answer(&webhook_rig_receiver, 1, statuses);
    webhook_rig_receiver.retry_after = "4";
    outlet_rig_events(rig, &a, 1, 1, "visit");
    webhook_rig_add(rig, NULL, true, webhook_rig_receiver.pair.certificate);
    const pid_t pid = outlet_rig_run(rig, WEBHOOK_RIG_LOG);
    receiver_wait(&webhook_rig_receiver, 2, 30);
    outlet_rig_end(pid);
    assert_in_range(webhook_rig_receiver.requests[1].at_ms - webhook_rig_receiver.requests[0].at_ms,
                    4000, 7000);
}

static void wait_stopped(struct store_rig *rig)
{
    for (int i = 0; i < 1000 && !outlet_rig_outlet(rig, "siem").stopped; i++) {
        const struct timespec pause = {.tv_nsec = 10000000};
        (void)nanosleep(&pause, NULL);
    }
    assert_true(outlet_rig_outlet(rig, "siem").stopped);
}

static void a_refusal_stops_the_outlet_until_it_is_resumed(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    const unsigned statuses[] = {403};
    const struct timespec pause = {.tv_sec = 3};
    const struct iso_fleet_id a = outlet_rig_door(rig, "A");
    receiver_answer(&webhook_rig_receiver, 1, statuses);
    outlet_rig_events(rig, &a, 1, 5, "visit");
    webhook_rig_add(rig, NULL, true, webhook_rig_receiver.pair.certificate);
    const pid_t pid = outlet_rig_run(rig, WEBHOOK_RIG_LOG);
    wait_stopped(rig);
    (void)nanosleep(&pause, NULL);
    assert_int_equal(webhook_rig_receiver.n, 1);
    assert_string_equal(outlet_rig_outlet(rig, "siem").trouble, "the receiver answers 403");
    store_rig_fine(hub_outlet_resume(&rig->store, "siem", &fault), &fault);
    outlet_rig_wait_idle(rig, "siem", 20);
    outlet_rig_end(pid);
    assert_int_equal(webhook_rig_arrivals().events, 5);
    char *log = scratch_read_text(WEBHOOK_RIG_LOG);
    assert_non_null(strstr(log, "outlet siem has stopped: the receiver answers 403"));
    free(log);
}

static void a_redirection_is_not_followed(void **state)
{
    struct store_rig *rig = *state;
    char location[64];
    const unsigned statuses[] = {307};
    const struct iso_fleet_id a = outlet_rig_door(rig, "A");
    (void)snprintf(location, sizeof location, "https://localhost:%u/elsewhere",
                   webhook_rig_receiver.port);
    receiver_answer(&webhook_rig_receiver, 1, statuses);
    webhook_rig_receiver.location = location;
    outlet_rig_events(rig, &a, 1, 1, "visit");
    webhook_rig_add(rig, NULL, true, webhook_rig_receiver.pair.certificate);
    const pid_t pid = outlet_rig_run(rig, WEBHOOK_RIG_LOG);
    wait_stopped(rig);
    outlet_rig_end(pid);
    assert_int_equal(webhook_rig_receiver.n, 1);
}

static void a_receiver_with_another_certificate_gets_nothing(void **state)
{
    struct store_rig *rig = *state;
    static struct receiver_pair other;
    const struct iso_fleet_id a = outlet_rig_door(rig, "A");
    receiver_pair_make(&other);
    outlet_rig_events(rig, &a, 1, 1, "visit");
    webhook_rig_add(rig, NULL, true, other.certificate);
    const pid_t pid = outlet_rig_run(rig, WEBHOOK_RIG_LOG);
    struct hub_outlet outlet = outlet_rig_outlet(rig, "siem");
    for (int i = 0; i < 1000 && outlet.failures < 2; i++) {
        const struct timespec pause = {.tv_nsec = 10000000};
        (void)nanosleep(&pause, NULL);
        outlet = outlet_rig_outlet(rig, "siem");
    }
    outlet_rig_end(pid);
    assert_true(outlet.failures >= 2);
    assert_non_null(strstr(outlet.trouble, "certificate"));
    assert_int_equal(webhook_rig_receiver.n, 0);
    assert_int_equal(outlet.delivered, 0);
}

static void a_removed_outlet_ends_and_a_test_arrives(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    const unsigned statuses[] = {200, 404};
    webhook_rig_add(rig, NULL, true, webhook_rig_receiver.pair.certificate);
    receiver_answer(&webhook_rig_receiver, 2, statuses);
    store_rig_now_s = time(NULL);
    store_rig_fine(hub_outlet_try(&rig->store, "siem", &fault), &fault);
    assert_int_equal(webhook_rig_receiver.n, 1);
    assert_true(webhook_rig_receiver.requests[0].is_genuine);
    assert_non_null(strstr(webhook_rig_receiver.requests[0].body, "\"event\":\"test\""));
    assert_int_equal(hub_outlet_try(&rig->store, "siem", &fault), -EREMOTEIO);
    assert_string_equal(fault.text, "siem: the receiver answers 404");
    store_rig_fine(hub_outlet_remove(&rig->store, "siem", &fault), &fault);
    assert_int_equal(hub_outlet_remove(&rig->store, "siem", &fault), -ENOENT);
    assert_int_equal(hub_outlet_try(&rig->store, "siem", &fault), -ENOENT);
    assert_int_equal(hub_outlet_resume(&rig->store, "siem", &fault), -ENOENT);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM outlet_cursor"), 0);
}

static void the_database_has_the_secret_only_sealed(void **state)
{
    struct store_rig *rig = *state;
    webhook_rig_add(rig, NULL, true, webhook_rig_receiver.pair.certificate);
    char *dump = rig_postgres_dump(&rig->postgres);
    char hex[2 * sizeof WEBHOOK_RIG_SECRET];
    (void)sodium_bin2hex(hex, sizeof hex, (const uint8_t *)WEBHOOK_RIG_SECRET,
                         strlen(WEBHOOK_RIG_SECRET));
    assert_non_null(strstr(dump, "siem"));
    assert_null(strstr(dump, WEBHOOK_RIG_SECRET));
    assert_null(strstr(dump, hex));
    free(dump);
}

static void what_is_not_allowed_is_not_added(void **state)
{
    struct store_rig *rig = *state;
    const struct hub_outlet_options good = {
        .name = "siem", .address = "https://example.org/", .kind = HUB_OUTLET_WEBHOOK};
    struct hub_outlet_options cases[6] = {good, good, good, good, good, good};
    struct iso_fault fault = {.text = ""};
    char out[HUB_OUTLET_SECRET_SIZE], again[HUB_OUTLET_SECRET_SIZE];
    cases[0].name = "";
    cases[1].address = "http://example.org/";
    cases[2].events = "visit,no-such-event";
    cases[3].secret = "too short";
    cases[4].secret = "has a blank in it, which is not allowed";
    cases[5].ca = "no certificate";
    for (size_t i = 0; i < 6; i++) {
        assert_int_equal(hub_outlet_add(&rig->store, &cases[i], out, &fault), -EINVAL);
    }
    store_rig_fine(hub_outlet_add(&rig->store, &good, out, &fault), &fault);
    assert_int_equal(strlen(out), 64);
    assert_int_equal(hub_outlet_add(&rig->store, &good, again, &fault), -EEXIST);
    assert_string_equal(fault.text, "siem: there is an outlet of this name");
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM act WHERE what = 'outlet-add'"),
                     1);
}

int main(int argc, char **argv)
{
    outlet_rig_main(argc, argv);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(events_arrive_signed_and_in_order, webhook_rig_setup,
                                        webhook_rig_teardown),
        cmocka_unit_test_setup_teardown(
            an_outlet_begins_with_the_next_event_and_keeps_to_its_filter, webhook_rig_setup,
            webhook_rig_teardown),
        cmocka_unit_test_setup_teardown(a_failing_receiver_is_asked_again_within_the_bounds,
                                        webhook_rig_setup, webhook_rig_teardown),
        cmocka_unit_test_setup_teardown(a_receiver_may_ask_for_time, webhook_rig_setup,
                                        webhook_rig_teardown),
        cmocka_unit_test_setup_teardown(a_refusal_stops_the_outlet_until_it_is_resumed,
                                        webhook_rig_setup, webhook_rig_teardown),
        cmocka_unit_test_setup_teardown(a_redirection_is_not_followed, webhook_rig_setup,
                                        webhook_rig_teardown),
        cmocka_unit_test_setup_teardown(a_receiver_with_another_certificate_gets_nothing,
                                        webhook_rig_setup, webhook_rig_teardown),
        cmocka_unit_test_setup_teardown(a_removed_outlet_ends_and_a_test_arrives, webhook_rig_setup,
                                        webhook_rig_teardown),
        cmocka_unit_test_setup_teardown(the_database_has_the_secret_only_sealed, webhook_rig_setup,
                                        webhook_rig_teardown),
        cmocka_unit_test_setup_teardown(what_is_not_allowed_is_not_added, webhook_rig_setup,
                                        webhook_rig_teardown),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}
