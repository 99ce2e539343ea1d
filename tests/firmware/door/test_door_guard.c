/* The door's guard: its thread, requests of other threads, and its reports. The tests check the
 * order of events, by lines for which a test can wait. They never check how long something takes.
 */
#include <errno.h>
#include <poll.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "firmware/door/door_guard.h"
#include "tests/support/devices/wired_door.h"

static struct iso_door_io *io;
static struct iso_door_guard *guard;
static struct iso_times times;
static atomic_int recorded;
static int64_t recorded_ns; /* of the last record */
static bool records = true; /* for the next guard, from its start on */

static void record(void *context, const struct iso_door_news *news)
{
    (void)context;
    assert_non_null(iso_door_state_name(news->state));
    assert_true(news->t_ns >= recorded_ns);
    recorded_ns = news->t_ns;
    atomic_fetch_add(&recorded, 1);
}

static int open_guard(int64_t unlock_ms)
{
    times = iso_times_system();
    atomic_store(&recorded, 0);
    recorded_ns = 0;
    io = wired_door_open();
    const struct iso_door_guard_options options = {
        .door = {.unlock_ns = unlock_ms * ISO_NS_PER_MS,
                 .held_ns = 3600 * ISO_NS_PER_S,
                 .refused_ns = ISO_NS_PER_MS},
        .timing = {.poll_ns = 3600 * ISO_NS_PER_S, /* the edges wake the thread */
                   .retry_ns = ISO_NS_PER_MS,
                   .retry_max_ns = ISO_NS_PER_MS},
        .clock = times.boottime,
        .io = io,
        .threaded = true,
        .record = records ? record : NULL,
    };
    const int error = iso_door_guard_new(&options, &guard);
    return error ? error : iso_door_guard_start(guard);
}

static int setup(void **state)
{
    (void)state;
    return open_guard(20);
}

static int setup_without_records(void **state)
{
    (void)state;
    records = false;
    const int error = open_guard(20);
    records = true;
    return error;
}

static int setup_slow(void **state)
{
    (void)state;
    return open_guard(3600 * 1000);
}

static int teardown(void **state)
{
    (void)state;
    iso_door_guard_stop(guard);
    assert_false(wired_door_level(ISO_DOOR_RELAY));
    iso_door_guard_free(guard);
    iso_door_io_close(io);
    return 0;
}

static void an_edge_wakes_it_and_so_does_the_time(void **state)
{
    (void)state;
    for (unsigned press = 1; press <= 5; press++) {
        wired_door_press();
        wired_door_await(ISO_DOOR_RELAY, 2 * press);
    }
}

/* The thread would wait for an hour. The grant makes it wait for the end of unlock_ms. */
static void a_grant_ends_by_itself(void **state)
{
    enum iso_door_answer answer = ISO_DOOR_NOT_ASKED;
    (void)state;
    assert_int_equal(iso_door_guard_grant(guard, ISO_NEVER_NS, &answer), 0);
    assert_int_equal(answer, ISO_DOOR_DID_UNLOCK);
    wired_door_await(ISO_DOOR_RELAY, 2);
    assert_int_equal(iso_door_guard_look(guard).state, ISO_DOOR_LOCKED);
}

static void a_grant_that_is_too_old_switches_nothing(void **state)
{
    enum iso_door_answer answer = ISO_DOOR_NOT_ASKED;
    (void)state;
    const int64_t now_ns = iso_times_boot_ns(&times);
    assert_int_equal(iso_door_guard_grant(guard, now_ns - 1, &answer), -ESTALE);
    assert_int_equal(answer, ISO_DOOR_NOT_ASKED);
    assert_int_equal(wired_door_switchings(ISO_DOOR_RELAY), 0);
    assert_int_equal(iso_door_guard_look(guard).state, ISO_DOOR_LOCKED);
}

/* The exit button has unlocked the door. An old grant does not prolong this, and does not end it.
 */
static void an_old_grant_does_not_lock_out_the_exit_button(void **state)
{
    enum iso_door_answer answer = ISO_DOOR_NOT_ASKED;
    (void)state;
    wired_door_press();
    wired_door_await(ISO_DOOR_RELAY, 1);
    assert_int_equal(iso_door_guard_grant(guard, 0, &answer), -ESTALE);
    assert_int_equal(wired_door_switchings(ISO_DOOR_RELAY), 1);
    assert_int_equal(iso_door_guard_look(guard).state, ISO_DOOR_UNLOCKED);
}

static void a_fault_locks_and_its_end_does_not_unlock(void **state)
{
    struct iso_fault fault = {.text = ""};
    (void)state;
    iso_door_guard_set_fault(guard, true);
    assert_int_equal(iso_door_guard_look(guard).state, ISO_DOOR_FAULT);
    assert_int_equal(iso_door_guard_may_test(guard, &fault), -EBUSY);
    iso_door_guard_set_fault(guard, false);
    assert_int_equal(iso_door_guard_look(guard).state, ISO_DOOR_LOCKED);
    assert_int_equal(iso_door_guard_test(guard, &fault), 0);
    wired_door_await(ISO_DOOR_RELAY, 2);
}

static void news_come_in_order_and_none_is_recorded_twice(void **state)
{
    struct iso_door_news news;
    char text[256] = "";
    size_t missed = 0;
    (void)state;
    wired_door_press();
    wired_door_await(ISO_DOOR_RELAY, 1);
    iso_door_guard_stop(guard);
    struct pollfd ready = {.fd = iso_door_guard_fd(guard), .events = POLLIN};
    assert_int_equal(poll(&ready, 1, 0), 1);
    while (iso_door_guard_next(guard, &news, &missed)) {
        const size_t used = strlen(text);
        (void)snprintf(text + used, sizeof text - used, "%s %s; ", iso_door_event_name(news.cause),
                       iso_door_state_name(news.state));
    }
    assert_string_equal(text, "start locked; exit-button unlocked; stop stopped; ");
    assert_int_equal(missed, 0);
    assert_int_equal(recorded, 3);
    assert_int_equal(poll(&ready, 1, 0), 0);
}

static void news_that_nobody_takes_are_counted(void **state)
{
    struct iso_door_news news;
    size_t missed = 0;
    (void)state;
    for (unsigned i = 1; i <= ISO_DOOR_GUARD_NEWS; i++) {
        wired_door_set(ISO_DOOR_TAMPER, true);
        wired_door_await(ISO_DOOR_BUZZER, 2 * i - 1);
        wired_door_set(ISO_DOOR_TAMPER, false);
        wired_door_await(ISO_DOOR_BUZZER, 2 * i);
    }
    iso_door_guard_stop(guard);
    assert_true(iso_door_guard_next(guard, &news, &missed));
    assert_int_equal(missed, 2 + 2 * ISO_DOOR_GUARD_NEWS - ISO_DOOR_GUARD_NEWS);
    assert_int_equal(news.cause, ISO_DOOR_ON_TAMPER_ENDED);
    assert_int_equal(recorded, 2 + 2 * ISO_DOOR_GUARD_NEWS); /* and none of them is lost */
}

/* The door stays unlocked for longer than a verdict is valid. */
static void the_card_of_an_old_grant_is_not_sent(void **state)
{
    const struct iso_wiegand_card card = {17, 4711};
    enum iso_door_answer answer = ISO_DOOR_NOT_ASKED;
    struct iso_fault fault = {.text = ""};
    (void)state;
    const int64_t until_ns = iso_times_boot_ns(&times) + 20 * ISO_NS_PER_MS;
    int error = iso_door_guard_grant(guard, until_ns, &answer);
    if (error == -ESTALE) {
        return; /* the test itself was stopped for that time */
    }
    assert_int_equal(error, 0);
    while (iso_times_boot_ns(&times) <= until_ns) {
        poll(NULL, 0, 5);
    }
    assert_int_equal(iso_door_guard_look(guard).state, ISO_DOOR_UNLOCKED);
    error = iso_door_guard_send_card(guard, &card, &fault);
    assert_int_equal(error, -ESTALE);
    assert_string_equal(fault.text, "the verdict is too old to send the card");
}

static void a_stopped_door_stays_so(void **state)
{
    (void)state;
    iso_door_guard_stop(guard);
    wired_door_press();
    assert_int_equal(iso_door_guard_look(guard).state, ISO_DOOR_STOPPED);
    iso_door_guard_free(guard); /* the thread has ended when this returns */
    assert_int_equal(wired_door_switchings(ISO_DOOR_RELAY), 0);
    iso_door_io_close(io);
    assert_int_equal(open_guard(20), 0); /* for the tear-down */
}

static void await_lock(void)
{
    while (iso_door_guard_look(guard).state != ISO_DOOR_LOCKED) {
        (void)poll(NULL, 0, 1);
    }
}

/* The door works before there is a log. The guard hands over the records of that time when there is
 * one. */
static void changes_wait_until_records_are_kept(void **state)
{
    (void)state;
    wired_door_press();
    wired_door_await(ISO_DOOR_RELAY, 2);
    await_lock();
    const int64_t before_ns = iso_times_boot_ns(&times);
    assert_int_equal(atomic_load(&recorded), 0);
    assert_int_equal(iso_door_guard_attach(guard, record, NULL), 0);
    assert_int_equal(atomic_load(&recorded), 3); /* start, exit-button, time */
    assert_true(recorded_ns > 0 && recorded_ns <= before_ns);
    wired_door_press();
    wired_door_await(ISO_DOOR_RELAY, 4);
    await_lock();
    assert_int_equal(atomic_load(&recorded), 5);
    iso_door_guard_detach(guard);
    wired_door_press();
    wired_door_await(ISO_DOOR_RELAY, 6);
    await_lock();
    assert_int_equal(atomic_load(&recorded), 5);
}

static void changes_that_are_too_many_are_counted(void **state)
{
    (void)state;
    for (unsigned press = 1; press <= ISO_DOOR_GUARD_NEWS; press++) {
        wired_door_press();
        wired_door_await(ISO_DOOR_RELAY, 2 * press);
    }
    await_lock();
    assert_int_equal(iso_door_guard_attach(guard, record, NULL), ISO_DOOR_GUARD_NEWS + 1);
    assert_int_equal(atomic_load(&recorded), ISO_DOOR_GUARD_NEWS);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(an_edge_wakes_it_and_so_does_the_time),
        TEST(a_grant_ends_by_itself),
        TEST(a_grant_that_is_too_old_switches_nothing),
        cmocka_unit_test_setup_teardown(an_old_grant_does_not_lock_out_the_exit_button, setup_slow,
                                        teardown),
        TEST(a_fault_locks_and_its_end_does_not_unlock),
        cmocka_unit_test_setup_teardown(news_come_in_order_and_none_is_recorded_twice, setup_slow,
                                        teardown),
        TEST(news_that_nobody_takes_are_counted),
        cmocka_unit_test_setup_teardown(the_card_of_an_old_grant_is_not_sent, setup_slow, teardown),
        TEST(a_stopped_door_stays_so),
        cmocka_unit_test_setup_teardown(changes_wait_until_records_are_kept, setup_without_records,
                                        teardown),
        cmocka_unit_test_setup_teardown(changes_that_are_too_many_are_counted,
                                        setup_without_records, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
