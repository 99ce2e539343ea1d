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

#include "enroll/hub/outlet/backoff.h"
#include "tests/enroll/hub/outlet/outlet_rig.h"
#include "tests/enroll/hub/outlet/receiver.h"
#include "tests/support/scratch.h"

static const char secret[] = "0123456789abcdef0123";
static const char log_file[] = "/tmp/isotherm-test-outlet.log";

static struct receiver receiver;

static int setup(void **state)
{
    (void)unlink(log_file);
    receiver_start(&receiver, secret);
    return store_rig_setup(state);
}

static int teardown(void **state)
{
    receiver_stop(&receiver);
    (void)unlink(log_file);
    return store_rig_teardown(state);
}

static void add(struct store_rig *rig, const char *events, bool from_beginning, const char *ca)
{
    struct iso_fault fault = {.text = ""};
    char address[64], out[HUB_OUTLET_SECRET_SIZE];
    (void)snprintf(address, sizeof address, "https://localhost:%u/events", receiver.port);
    const struct hub_outlet_options options = {.name = "siem",
                                               .address = address,
                                               .kind = HUB_OUTLET_WEBHOOK,
                                               .events = events,
                                               .secret = secret,
                                               .ca = ca,
                                               .from_beginning = from_beginning};
    store_rig_fine(hub_outlet_add(&rig->store, &options, out, &fault), &fault);
    assert_string_equal(out, secret);
}

/* ---- what has arrived ---- */

struct arrivals {
    size_t n_doors;
    char doors[16][ISO_FLEET_ID_TEXT_SIZE];
    uint64_t last[16]; /* the highest number of each door */
    size_t events, repeated_batches;
};

static size_t door_of(struct arrivals *arrivals, const char *text)
{
    size_t i = 0;
    while (i < arrivals->n_doors && strcmp(arrivals->doors[i], text) != 0) {
        i++;
    }
    if (i == arrivals->n_doors) {
        assert_true(arrivals->n_doors < 16);
        (void)snprintf(arrivals->doors[arrivals->n_doors++], sizeof *arrivals->doors, "%s", text);
    }
    return i;
}

static bool is_repeated(size_t request)
{
    for (size_t i = 0; i < request; i++) {
        if (receiver.requests[i].status == 200 &&
            strcmp(receiver.requests[i].key, receiver.requests[request].key) == 0) {
            /* The same key means the same batch. */
            if (strcmp(receiver.requests[i].body, receiver.requests[request].body) != 0) {
                fail_msg("two batches have the key %s", receiver.requests[i].key);
            }
            return true;
        }
    }
    return false;
}

/* Reads the batches that were taken as a receiver does: what has a known key was there before. The
 * events of each door have to come without a gap, a repetition or a change of their order. */
static struct arrivals read_arrivals(uint64_t step)
{
    struct arrivals arrivals = {.n_doors = 0};
    for (size_t i = 0; i < receiver.n; i++) {
        assert_true(receiver.requests[i].is_genuine);
        if (receiver.requests[i].status != 200) {
            continue;
        }
        if (is_repeated(i)) {
            arrivals.repeated_batches++;
            continue;
        }
        json_t *array = json_loads(receiver.requests[i].body, 0, NULL);
        size_t k;
        json_t *event;
        assert_true(json_array_size(array) > 0);
        json_array_foreach(array, k, event)
        {
            const size_t door = door_of(&arrivals,
                                        json_string_value(json_object_get(event, "door")));
            const uint64_t number = (uint64_t)json_integer_value(json_object_get(event, "number"));
            if (number != arrivals.last[door] + step) {
                fail_msg("%llu comes after %llu", (unsigned long long)number,
                         (unsigned long long)arrivals.last[door]);
            }
            arrivals.last[door] = number;
            arrivals.events++;
        }
        json_decref(array);
    }
    return arrivals;
}

/* ---- the tests ---- */

static void events_arrive_signed_and_in_order(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id a = outlet_rig_door(rig, "A"), b = outlet_rig_door(rig, "B");
    outlet_rig_events(rig, &a, 1, 450, "visit");
    outlet_rig_events(rig, &b, 1, 3, "visit");
    add(rig, NULL, true, receiver.pair.certificate);
    const pid_t pid = outlet_rig_run(rig, log_file);
    outlet_rig_wait_idle(rig, "siem", 20);
    outlet_rig_events(rig, &b, 4, 5, "attack");
    outlet_rig_wait_idle(rig, "siem", 20);
    outlet_rig_end(pid);
    const struct arrivals arrivals = read_arrivals(1);
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
    add(rig, "attack,duress", false, receiver.pair.certificate);
    outlet_rig_events(rig, &a, 11, 20, "visit");
    outlet_rig_events(rig, &a, 21, 21, "duress");
    outlet_rig_events(rig, &a, 22, 22, "attack");
    outlet_rig_events(rig, &a, 23, 30, "visit");
    const pid_t pid = outlet_rig_run(rig, log_file);
    outlet_rig_wait_idle(rig, "siem", 20);
    outlet_rig_end(pid);
    assert_int_equal(receiver.n, 1);
    json_t *array = json_loads(receiver.requests[0].body, 0, NULL);
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
    receiver_answer(&receiver, 3, statuses);
    outlet_rig_events(rig, &a, 1, 2, "visit");
    add(rig, NULL, true, receiver.pair.certificate);
    const pid_t pid = outlet_rig_run(rig, log_file);
    receiver_wait(&receiver, 4, 30);
    outlet_rig_wait_idle(rig, "siem", 10);
    outlet_rig_end(pid);
    int64_t most_ms = HUB__BACKOFF_FIRST_MS;
    for (size_t i = 1; i < 4; i++) {
        const int64_t gap_ms = receiver.requests[i].at_ms - receiver.requests[i - 1].at_ms;
        /* It looks again every half second, and this machine may be busy. */
        assert_in_range(gap_ms, most_ms / 2, most_ms + 1500);
        assert_string_equal(receiver.requests[i].key, receiver.requests[0].key);
        most_ms *= 2;
    }
    assert_int_equal(read_arrivals(1).events, 2);
    assert_int_equal(outlet_rig_outlet(rig, "siem").failures, 0);
    char *log = scratch_read_text(log_file);
    assert_non_null(strstr(log, "outlet siem: the receiver answers 500; failure 1"));
    assert_non_null(strstr(log, "outlet siem: it works again, after 3 failures"));
    free(log);
}

static void a_receiver_may_ask_for_time(void **state)
{
    struct store_rig *rig = *state;
    const unsigned statuses[] = {429};
    const struct iso_fleet_id a = outlet_rig_door(rig, "A");
    receiver_answer(&receiver, 1, statuses);
    receiver.retry_after = "4";
    outlet_rig_events(rig, &a, 1, 1, "visit");
    add(rig, NULL, true, receiver.pair.certificate);
    const pid_t pid = outlet_rig_run(rig, log_file);
    receiver_wait(&receiver, 2, 30);
    outlet_rig_end(pid);
    assert_in_range(receiver.requests[1].at_ms - receiver.requests[0].at_ms, 4000, 7000);
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
    receiver_answer(&receiver, 1, statuses);
    outlet_rig_events(rig, &a, 1, 5, "visit");
    add(rig, NULL, true, receiver.pair.certificate);
    const pid_t pid = outlet_rig_run(rig, log_file);
    wait_stopped(rig);
    (void)nanosleep(&pause, NULL);
    assert_int_equal(receiver.n, 1);
    assert_string_equal(outlet_rig_outlet(rig, "siem").trouble, "the receiver answers 403");
    store_rig_fine(hub_outlet_resume(&rig->store, "siem", &fault), &fault);
    outlet_rig_wait_idle(rig, "siem", 20);
    outlet_rig_end(pid);
    assert_int_equal(read_arrivals(1).events, 5);
    char *log = scratch_read_text(log_file);
    assert_non_null(strstr(log, "outlet siem has stopped: the receiver answers 403"));
    free(log);
}

static void a_redirection_is_not_followed(void **state)
{
    struct store_rig *rig = *state;
    char location[64];
    const unsigned statuses[] = {307};
    const struct iso_fleet_id a = outlet_rig_door(rig, "A");
    (void)snprintf(location, sizeof location, "https://localhost:%u/elsewhere", receiver.port);
    receiver_answer(&receiver, 1, statuses);
    receiver.location = location;
    outlet_rig_events(rig, &a, 1, 1, "visit");
    add(rig, NULL, true, receiver.pair.certificate);
    const pid_t pid = outlet_rig_run(rig, log_file);
    wait_stopped(rig);
    outlet_rig_end(pid);
    assert_int_equal(receiver.n, 1);
}

static void a_receiver_with_another_certificate_gets_nothing(void **state)
{
    struct store_rig *rig = *state;
    static struct receiver_pair other;
    const struct iso_fleet_id a = outlet_rig_door(rig, "A");
    receiver_pair_make(&other);
    outlet_rig_events(rig, &a, 1, 1, "visit");
    add(rig, NULL, true, other.certificate);
    const pid_t pid = outlet_rig_run(rig, log_file);
    struct hub_outlet outlet = outlet_rig_outlet(rig, "siem");
    for (int i = 0; i < 1000 && outlet.failures < 2; i++) {
        const struct timespec pause = {.tv_nsec = 10000000};
        (void)nanosleep(&pause, NULL);
        outlet = outlet_rig_outlet(rig, "siem");
    }
    outlet_rig_end(pid);
    assert_true(outlet.failures >= 2);
    assert_non_null(strstr(outlet.trouble, "certificate"));
    assert_int_equal(receiver.n, 0);
    assert_int_equal(outlet.delivered, 0);
}

/* The process dies while batches are handed over, again and again. */
static void no_event_is_lost_when_the_process_is_killed(void **state)
{
    struct store_rig *rig = *state;
    enum { DOORS = 6, EVENTS = 500, KILLS = 12 };
    struct iso_fleet_id doors[DOORS];
    receiver.delay_ms = 20;
    add(rig, NULL, true, receiver.pair.certificate);
    for (int i = 0; i < DOORS; i++) {
        char name[2] = {(char)('A' + i), '\0'};
        doors[i] = outlet_rig_door(rig, name);
    }
    pid_t pid = outlet_rig_run(rig, log_file);
    for (int kill = 0; kill < KILLS; kill++) {
        const struct timespec pause = {.tv_nsec = 150000000 + 17000000L * kill};
        for (int i = 0; i < DOORS; i++) {
            const uint64_t from = (uint64_t)kill * EVENTS + 1;
            outlet_rig_events(rig, &doors[i], from, from + EVENTS - 1, "visit");
        }
        (void)nanosleep(&pause, NULL);
        outlet_rig_kill(pid);
        pid = outlet_rig_run(rig, log_file);
    }
    outlet_rig_wait_idle(rig, "siem", 120);
    outlet_rig_end(pid);
    const struct arrivals arrivals = read_arrivals(1);
    print_message("%zu events in %zu requests, %zu batches came twice\n", arrivals.events,
                  receiver.n, arrivals.repeated_batches);
    assert_int_equal(arrivals.n_doors, DOORS);
    assert_int_equal(arrivals.events, DOORS * EVENTS * KILLS);
    assert_int_equal(outlet_rig_outlet(rig, "siem").delivered, DOORS * EVENTS * KILLS);
}

static void two_leaders_hand_over_nothing_twice_under_another_key(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id a = outlet_rig_door(rig, "A");
    outlet_rig_events(rig, &a, 1, 3000, "visit");
    add(rig, NULL, true, receiver.pair.certificate);
    const pid_t one = outlet_rig_run(rig, log_file), two = outlet_rig_run(rig, log_file);
    outlet_rig_wait_idle(rig, "siem", 60);
    outlet_rig_end(one);
    outlet_rig_end(two);
    assert_int_equal(read_arrivals(1).events, 3000);
    assert_int_equal(outlet_rig_outlet(rig, "siem").delivered, 3000);
}

/* The process ends at once although the receiver hangs, and the database may be away for a while.
 */
static void it_survives_the_database_and_ends_at_once(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id a = outlet_rig_door(rig, "A");
    add(rig, NULL, true, receiver.pair.certificate);
    const pid_t pid = outlet_rig_run(rig, log_file);
    outlet_rig_events(rig, &a, 1, 1, "visit");
    outlet_rig_wait_idle(rig, "siem", 20);
    rig_postgres_down(&rig->postgres);
    const struct timespec pause = {.tv_sec = 3};
    (void)nanosleep(&pause, NULL);
    rig_postgres_up(&rig->postgres);
    hub_store_close(&rig->store);
    store_rig_open(rig, &rig->store);
    outlet_rig_events(rig, &a, 2, 2, "visit");
    outlet_rig_wait_idle(rig, "siem", 20);
    assert_int_equal(read_arrivals(1).events, 2);
    receiver.delay_ms = 8000;
    outlet_rig_events(rig, &a, 3, 3, "visit");
    receiver_wait(&receiver, 3, 20);
    outlet_rig_end(pid);
    assert_true(outlet_rig_outlet(rig, "siem").in_flight);
    receiver.delay_ms = 0;
}

static void a_removed_outlet_ends_and_a_test_arrives(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    const unsigned statuses[] = {200, 404};
    add(rig, NULL, true, receiver.pair.certificate);
    receiver_answer(&receiver, 2, statuses);
    store_rig_now_s = time(NULL);
    store_rig_fine(hub_outlet_test(&rig->store, "siem", &fault), &fault);
    assert_int_equal(receiver.n, 1);
    assert_true(receiver.requests[0].is_genuine);
    assert_non_null(strstr(receiver.requests[0].body, "\"event\":\"test\""));
    assert_int_equal(hub_outlet_test(&rig->store, "siem", &fault), -EREMOTEIO);
    assert_string_equal(fault.text, "siem: the receiver answers 404");
    store_rig_fine(hub_outlet_remove(&rig->store, "siem", &fault), &fault);
    assert_int_equal(hub_outlet_remove(&rig->store, "siem", &fault), -ENOENT);
    assert_int_equal(hub_outlet_test(&rig->store, "siem", &fault), -ENOENT);
    assert_int_equal(hub_outlet_resume(&rig->store, "siem", &fault), -ENOENT);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM outlet_cursor"), 0);
}

static void the_database_has_the_secret_only_sealed(void **state)
{
    struct store_rig *rig = *state;
    add(rig, NULL, true, receiver.pair.certificate);
    char *dump = rig_postgres_dump(&rig->postgres);
    char hex[2 * sizeof secret];
    (void)sodium_bin2hex(hex, sizeof hex, (const uint8_t *)secret, strlen(secret));
    assert_non_null(strstr(dump, "siem"));
    assert_null(strstr(dump, secret));
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
        cmocka_unit_test_setup_teardown(events_arrive_signed_and_in_order, setup, teardown),
        cmocka_unit_test_setup_teardown(
            an_outlet_begins_with_the_next_event_and_keeps_to_its_filter, setup, teardown),
        cmocka_unit_test_setup_teardown(a_failing_receiver_is_asked_again_within_the_bounds, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(a_receiver_may_ask_for_time, setup, teardown),
        cmocka_unit_test_setup_teardown(a_refusal_stops_the_outlet_until_it_is_resumed, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(a_redirection_is_not_followed, setup, teardown),
        cmocka_unit_test_setup_teardown(a_receiver_with_another_certificate_gets_nothing, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(no_event_is_lost_when_the_process_is_killed, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(two_leaders_hand_over_nothing_twice_under_another_key,
                                        setup, teardown),
        cmocka_unit_test_setup_teardown(it_survives_the_database_and_ends_at_once, setup, teardown),
        cmocka_unit_test_setup_teardown(a_removed_outlet_ends_and_a_test_arrives, setup, teardown),
        cmocka_unit_test_setup_teardown(the_database_has_the_secret_only_sealed, setup, teardown),
        cmocka_unit_test_setup_teardown(what_is_not_allowed_is_not_added, setup, teardown),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}
