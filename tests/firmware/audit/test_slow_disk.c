/* The door does not wait for the disk: an appliance with its threads on a disk that hangs. What is
 * tested is what happens before the disk answers, never how long it takes. */
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/audit/journal.h"
#include "firmware/config/door_options.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/firmware/rigs/stores.h"
#include "tests/support/devices/wired_door.h"
#include "tests/support/disk/slow_disk.h"

enum { STOPPED_S = 3, UNLOCK_MS = 50, VISITS_MAX = 100, LONG_MS = 600000 };

/* ---- the appliance ---- */

static int setup(void **state)
{
    if (rig_setup(state)) {
        return -1;
    }
    struct rig *rig = *state;
    iso_appliance_free(rig->appliance);
    iso_door_io_close(rig->door_io);
    iso_audit_close(rig->audit);
    rig->borrowed.times = iso_times_system();
    rig->borrowed.threads = true;
    rig->sensor.clock = rig->borrowed.times.monotonic;
    rig->borrowed.door_io = rig->door_io = wired_door_open();
    const struct iso_audit_options audit = stores_audit(rig->directory);
    assert_int_equal(iso_audit_open(&audit, &rig->borrowed.times, &rig->audit, NULL), 0);
    rig->borrowed.audit = rig->audit;
    rig->config.door.unlock_ms = UNLOCK_MS;
    rig->config.decision.refractory_ms = 1;
    rig->config.sensor.stale_ms = LONG_MS; /* this machine may have better things to do */
    rig_enrol(rig, "anna", 50);
    return iso_appliance_new(&rig->borrowed, &rig->appliance);
}

static int teardown(void **state)
{
    slow_disk_take_ms(0);
    slow_disk_go_on();
    return rig_teardown(state);
}

/* Nothing waits for the disk any more. */
static void settle(struct rig *rig)
{
    (void)iso_audit_writer_hold(iso_appliance_log(rig->appliance));
    iso_audit_writer_release(iso_appliance_log(rig->appliance));
}

/* Starts it, and nothing is under way. */
static void start(struct rig *rig)
{
    rig_start(rig);
    settle(rig);
    (void)rig_news(rig);
}

/* The disk hangs, and somebody waits for it. */
static void hang(void)
{
    slow_disk_hang();
    wired_door_press();
    slow_disk_await();
}

static void wait_a_moment(void)
{
    const struct timespec moment = {.tv_nsec = 1000000};
    (void)nanosleep(&moment, NULL);
}

/* Anna comes, and the appliance steps until it has a verdict. */
static const char *come(struct rig *rig)
{
    static char all[4096];
    all[0] = '\0';
    while (!strstr(all, "visit ")) {
        if (rig->sensor.next == rig->sensor.n_frames) {
            const int64_t now_ns = iso_times_now_ns(&rig->borrowed.times);
            puppet_sensor_add(&rig->sensor, now_ns, 50, ISO_CAPTURE_OK);
        }
        (void)iso_appliance_step(rig->appliance);
        (void)strncat(all, rig_news(rig), sizeof all - strlen(all) - 1);
        wait_a_moment();
    }
    return all;
}

/* The log's records from the first on, with the disk in order. */
static const char *last_record(struct rig *rig, const char *event)
{
    settle(rig);
    return rig_record(rig, event);
}

/* ---- tests ---- */

/* Nobody steps the appliance meanwhile, as if a frame took for ever. */
static void relay_and_exit_do_not_wait_for_the_disk(void **state)
{
    struct rig *rig = *state;
    start(rig);
    hang();
    wired_door_await(ISO_DOOR_RELAY, 2); /* on, and off again */
    for (unsigned press = 2; press <= 20; press++) {
        wired_door_press();
        wired_door_await(ISO_DOOR_RELAY, 2 * press);
    }
    assert_false(wired_door_level(ISO_DOOR_RELAY));
    assert_int_equal(slow_disk_waiting(), 1); /* all that before the disk has answered */
}

static void contact_and_tamper_do_not_wait_for_the_disk(void **state)
{
    struct rig *rig = *state;
    start(rig);
    hang();
    wired_door_await(ISO_DOOR_RELAY, 2);
    wired_door_set(ISO_DOOR_TAMPER, true);
    wired_door_await(ISO_DOOR_BUZZER, 1);
    wired_door_set(ISO_DOOR_TAMPER, false);
    wired_door_await(ISO_DOOR_BUZZER, 2);
    wired_door_set(ISO_DOOR_CONTACT, true); /* forced */
    wired_door_await(ISO_DOOR_BUZZER, 3);
    wired_door_set(ISO_DOOR_CONTACT, false);
    wired_door_await(ISO_DOOR_BUZZER, 4);
    assert_int_equal(slow_disk_waiting(), 1);
    slow_disk_go_on();
    assert_non_null(strstr(last_record(rig, "door"), "\"reason\":\"closed\",\"note\":\"locked\""));
}

static void whoever_is_known_is_let_in_while_the_disk_works(void **state)
{
    struct rig *rig = *state;
    const char *news = "";
    start(rig);
    for (int i = 0; i < VISITS_MAX && !strstr(news, "visit allow anna match 2"); i++) {
        news = come(rig); /* once, but on a machine that takes 250 ms to wake up a thread */
    }
    wired_door_await(ISO_DOOR_RELAY, 2);
    const char *visit = last_record(rig, "visit");
    assert_non_null(strstr(visit, "\"verdict\":\"allow\",\"door\":\"unlocked\",\"grant\":"));
}

static void a_grant_that_is_not_on_record_lets_nobody_in(void **state)
{
    struct rig *rig = *state;
    start(rig);
    do { /* once, but on a machine that takes 250 ms to wake up a thread */
        slow_disk_go_on();
        slow_disk_hang();
        assert_non_null(strstr(come(rig), "visit deny anna not-on-record 2"));
    } while (slow_disk_waiting() == 0); /* it hangs with the record of the grant */
    slow_disk_go_on();
    const char *grant = strstr(last_record(rig, "grant"), "\"sequence\":");
    assert_non_null(grant);
    char behind[64];
    (void)snprintf(behind, sizeof behind, "\"grant\":%lu,\"reason\":\"not-on-record\"",
                   strtoul(grant + strlen("\"sequence\":"), NULL, 10));
    const char *visit = last_record(rig, "visit");
    assert_non_null(strstr(visit, "\"verdict\":\"deny\""));
    assert_non_null(strstr(visit, behind));
    assert_int_equal(wired_door_switchings(ISO_DOOR_RELAY), 0);
}

/* A grant that waits in the queue behind other records is not written at all. */
static void a_grant_that_was_not_begun_is_forgotten(void **state)
{
    struct rig *rig = *state;
    start(rig);
    hang();
    wired_door_await(ISO_DOOR_RELAY, 2);
    assert_non_null(strstr(come(rig), "visit deny anna not-on-record 2"));
    slow_disk_go_on();
    assert_string_equal(last_record(rig, "grant"), "");
    const char *visit = last_record(rig, "visit");
    assert_non_null(strstr(visit, "\"verdict\":\"deny\",\"reason\":\"not-on-record\""));
    assert_int_equal(wired_door_switchings(ISO_DOOR_RELAY), 2);
}

static void a_full_queue_lets_nobody_in(void **state)
{
    struct rig *rig = *state;
    const struct iso_audit_record record = iso_audit_record_of("test");
    start(rig);
    hang();
    wired_door_await(ISO_DOOR_RELAY, 2);
    while (iso_audit_writer_post(iso_appliance_log(rig->appliance), &record, NULL) == 0) {
    }
    /* The first grant and its outcome take the places that are kept for them. */
    assert_non_null(strstr(come(rig), "visit deny anna not-on-record 2"));
    assert_non_null(strstr(come(rig), "visit deny anna not-on-record 2"));
    assert_int_equal(wired_door_switchings(ISO_DOOR_RELAY), 2);
    wired_door_press(); /* the exit button works all the same */
    wired_door_await(ISO_DOOR_RELAY, 4);
    assert_int_equal(slow_disk_waiting(), 1);
    slow_disk_go_on();
    assert_string_equal(last_record(rig, "grant"), "");
    assert_non_null(strstr(last_record(rig, "records-lost"), " records\""));
}

/* ---- a contact that chatters ---- */

enum { DISK_MS = 20, CHATTER_HZ = 200, RECORDS_MAX = 60 };

static atomic_bool chatters;

/* Opens and closes the contact CHATTER_HZ times a second. */
static void *chatter(void *context)
{
    const struct timespec half = {.tv_nsec = 1000000000L / (2 * CHATTER_HZ)};
    (void)context;
    while (chatters) {
        wired_door_set(ISO_DOOR_CONTACT, true);
        (void)nanosleep(&half, NULL);
        wired_door_set(ISO_DOOR_CONTACT, false);
        (void)nanosleep(&half, NULL);
    }
    return NULL;
}

/* The record of the grant is waited for by no more than 250 ms. */
static void a_chattering_contact_keeps_nobody_out(void **state)
{
    struct rig *rig = *state;
    pthread_t thread;
    int admitted = 0;
    start(rig);
    const uint64_t before = iso_audit_writer_last(iso_appliance_log(rig->appliance));
    slow_disk_take_ms(DISK_MS);
    chatters = true;
    assert_int_equal(pthread_create(&thread, NULL, chatter, NULL), 0);
    wired_door_await(ISO_DOOR_BUZZER, 2 * CHATTER_HZ); /* it has been going on for a while */
    for (int i = 0; i < VISITS_MAX && admitted < 3; i++) {
        admitted += strstr(come(rig), "visit allow anna match 2") != NULL;
    }
    chatters = false;
    assert_int_equal(pthread_join(thread, NULL), 0);
    slow_disk_take_ms(0);
    assert_int_equal(admitted, 3);
    iso_appliance_stop(rig->appliance);
    assert_string_equal(last_record(rig, "records-lost"), "");
    const uint64_t last = iso_audit_writer_last(iso_appliance_log(rig->appliance));
    assert_in_range(last - before, 1, RECORDS_MAX);
}

/* ---- a journal that is stuck ---- */

static struct {
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    bool stuck;
} journal = {.mutex = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};

static int send_when_it_works(const struct iovec *fields, int n)
{
    (void)fields;
    (void)n;
    (void)pthread_mutex_lock(&journal.mutex);
    while (journal.stuck) {
        (void)pthread_cond_wait(&journal.changed, &journal.mutex);
    }
    (void)pthread_mutex_unlock(&journal.mutex);
    return 0;
}

static void let_journal_work(void)
{
    (void)pthread_mutex_lock(&journal.mutex);
    journal.stuck = false;
    (void)pthread_cond_broadcast(&journal.changed);
    (void)pthread_mutex_unlock(&journal.mutex);
}

/* The log of the rig, told to this journal. */
static void open_told_log(struct rig *rig, struct iso_journal *to)
{
    struct iso_audit_options audit = stores_audit(rig->directory);
    audit.written = iso_journal_record;
    audit.context = to;
    iso_appliance_free(rig->appliance);
    iso_audit_close(rig->audit);
    assert_int_equal(iso_audit_open(&audit, &rig->borrowed.times, &rig->audit, NULL), 0);
    rig->borrowed.audit = rig->audit;
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
}

static void a_stuck_journal_keeps_nobody_out(void **state)
{
    struct rig *rig = *state;
    struct iso_journal *to = NULL;
    const char *news = "";
    journal.stuck = true;
    assert_int_equal(iso_journal_new(send_when_it_works, &to), 0);
    open_told_log(rig, to);
    start(rig);
    for (int i = 0; i < VISITS_MAX && !strstr(news, "visit allow anna match 2"); i++) {
        news = come(rig); /* once, but on a machine that takes 250 ms to wake up a thread */
    }
    assert_true(journal.stuck);
    assert_non_null(strstr(news, "visit allow anna match 2"));
    let_journal_work();
    iso_appliance_stop(rig->appliance);
    settle(rig);
    iso_journal_free(to);
    rig->audit = NULL;
    iso_appliance_free(rig->appliance);
    iso_audit_close(rig->borrowed.audit);
    rig->appliance = NULL;
}

static void *remove_anna(void *context)
{
    struct rig *rig = context;
    const int error = iso_appliance_remove(rig->appliance, "anna", NULL);
    return (void *)(intptr_t)error;
}

static void administration_does_not_keep_the_door_waiting(void **state)
{
    struct rig *rig = *state;
    pthread_t thread;
    void *result = NULL;
    start(rig);
    slow_disk_hang();
    assert_int_equal(pthread_create(&thread, NULL, remove_anna, rig), 0);
    slow_disk_await();
    for (unsigned press = 1; press <= 3; press++) {
        wired_door_press();
        wired_door_await(ISO_DOOR_RELAY, 2 * press);
    }
    assert_true(slow_disk_waiting() > 0);
    slow_disk_go_on();
    assert_int_equal(pthread_join(thread, &result), 0);
    assert_null(result);
}

/* ---- the start ---- */

static void *start_appliance(void *context)
{
    const struct rig *rig = context;
    const int error = iso_appliance_start(rig->appliance, NULL);
    return (void *)(intptr_t)error;
}

/* Has the appliance started by a thread, on a disk that hangs, until the disk is waited for. */
static pthread_t start_slowly(struct rig *rig)
{
    pthread_t thread;
    slow_disk_hang();
    assert_int_equal(pthread_create(&thread, NULL, start_appliance, rig), 0);
    slow_disk_await();
    return thread;
}

static void end_start(pthread_t thread)
{
    void *result = NULL;
    slow_disk_go_on();
    assert_int_equal(pthread_join(thread, &result), 0);
    assert_null(result);
}

static void the_exit_button_works_before_the_start_is_on_record(void **state)
{
    struct rig *rig = *state;
    const pthread_t thread = start_slowly(rig);
    for (unsigned press = 1; press <= 3; press++) {
        wired_door_press();
        wired_door_await(ISO_DOOR_RELAY, 2 * press);
    }
    assert_int_equal(slow_disk_waiting(), 1);
    assert_int_equal(rig->sensor.opened, 0); /* not before the records */
    end_start(thread);
    assert_non_null(strstr(last_record(rig, "door"), "\"reason\":\"time\",\"note\":\"locked\""));
    assert_non_null(strstr(last_record(rig, "start"), "\"sequence\":1,"));
}

static int64_t time_of(const char *record)
{
    const char *member = strstr(record, "\"monotonic_ns\":");
    assert_non_null(member);
    return strtoll(member + strlen("\"monotonic_ns\":"), NULL, 10);
}

/* As the daemon does it: the door works before gallery and log are open. Its records of that time
 * come behind "start", and tell when it was. */
static void a_door_that_works_already_is_taken_over(void **state)
{
    struct rig *rig = *state;
    struct iso_door_guard *guard = NULL;
    const struct iso_door_guard_options options = iso_door_options_of(
        &rig->config.door, &rig->borrowed.times, rig->door_io, true);
    iso_appliance_free(rig->appliance);
    assert_int_equal(iso_door_guard_new(&options, &guard), 0);
    assert_int_equal(iso_door_guard_start(guard), 0);
    wired_door_press();
    wired_door_await(ISO_DOOR_RELAY, 2);
    while (iso_door_guard_look(guard).state != ISO_DOOR_LOCKED) {
        wait_a_moment();
    }
    const int64_t before_ns = iso_times_now_ns(&rig->borrowed.times);
    rig->borrowed.door = guard;
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    const pthread_t thread = start_slowly(rig);
    assert_int_equal(slow_disk_waiting(), 1);
    end_start(thread);
    const char *door = last_record(rig, "door");
    assert_non_null(strstr(door, "\"sequence\":4,"));
    assert_non_null(strstr(door, "\"reason\":\"time\",\"note\":\"locked\""));
    assert_true(time_of(door) <= before_ns);
    iso_appliance_stop(rig->appliance);
    iso_appliance_free(rig->appliance);
    rig->appliance = NULL;
    iso_door_guard_free(guard);
}

/* ---- a sensor whose frames wait for a main thread that waits for the disk ---- */

enum { PAUSE_MS = 100, STALL_MS = 3 * PAUSE_MS };

static int setup_fail_safe(void **state)
{
    if (setup(state)) {
        return -1;
    }
    struct rig *rig = *state;
    iso_appliance_free(rig->appliance);
    rig->config.door.fail = ISO_DOOR_FAIL_SAFE;
    rig->config.sensor.pause_ms = PAUSE_MS;
    rig->config.sensor.stale_ms = PAUSE_MS;
    rig->config.sensor.silence_ms = 2 * PAUSE_MS;
    rig->sensor.streams = true;
    return iso_appliance_new(&rig->borrowed, &rig->appliance);
}

/* A frame without anybody, as a camera has one all the time. */
static void show_nobody(struct rig *rig)
{
    const int64_t now_ns = iso_times_now_ns(&rig->borrowed.times);
    puppet_sensor_add(&rig->sensor, now_ns, 0, ISO_CAPTURE_NO_FACE);
}

/* Removes anna, for which the disk takes STALL_MS; frames of before and behind wait meanwhile. */
static void stall(struct rig *rig)
{
    const struct timespec stall = {.tv_nsec = STALL_MS * 1000000L};
    pthread_t thread;
    void *result = NULL;
    slow_disk_hang();
    assert_int_equal(pthread_create(&thread, NULL, remove_anna, rig), 0);
    slow_disk_await();
    show_nobody(rig);
    (void)nanosleep(&stall, NULL);
    slow_disk_go_on();
    assert_int_equal(pthread_join(thread, &result), 0);
    assert_null(result);
}

static void a_slow_disk_does_not_release_a_fail_safe_door(void **state)
{
    struct rig *rig = *state;
    show_nobody(rig);
    start(rig);
    wired_door_await(ISO_DOOR_RELAY, 1); /* the magnet holds */
    (void)iso_appliance_step(rig->appliance);
    stall(rig);
    (void)iso_appliance_step(rig->appliance); /* the old frame */
    for (int i = 0; i < 20; i++) {
        show_nobody(rig);
        (void)iso_appliance_step(rig->appliance);
    }
    assert_int_equal(wired_door_switchings(ISO_DOOR_RELAY), 1);
    assert_true(wired_door_level(ISO_DOOR_RELAY));
    assert_null(strstr(rig_news(rig), "fault"));
}

/* Frames from before the stall are no reason to let anybody in, although it was not their fault. */
static void frames_from_before_a_stall_let_nobody_in(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "berta", 60);
    show_nobody(rig);
    start(rig);
    wired_door_await(ISO_DOOR_RELAY, 1);
    (void)iso_appliance_step(rig->appliance);
    for (int i = 0; i < 4; i++) {
        puppet_sensor_add(&rig->sensor, iso_times_now_ns(&rig->borrowed.times), 60, ISO_CAPTURE_OK);
    }
    stall(rig);
    for (int i = 0; i < 6; i++) {
        (void)iso_appliance_step(rig->appliance);
    }
    assert_int_equal(wired_door_switchings(ISO_DOOR_RELAY), 1);
    assert_null(strstr(rig_news(rig), "visit allow"));
}

/* Its camera was unplugged during the stall. */
static void a_dead_sensor_is_a_fault_behind_a_stall(void **state)
{
    struct rig *rig = *state;
    char all[4096] = "";
    show_nobody(rig);
    start(rig);
    wired_door_await(ISO_DOOR_RELAY, 1);
    (void)iso_appliance_step(rig->appliance);
    stall(rig);
    while (!strstr(all, "door fault fault")) { /* the test's time-out ends it if it never comes */
        (void)iso_appliance_step(rig->appliance);
        (void)strncat(all, rig_news(rig), sizeof all - strlen(all) - 1);
        wait_a_moment();
    }
    wired_door_await(ISO_DOOR_RELAY, 2);
    assert_false(wired_door_level(ISO_DOOR_RELAY));
}

/* ---- a process that is stopped ---- */

/* In a process of its own, which stops itself when the record of the grant is to be synchronised.
 * Returns its exit code: 0 if nobody was let in. */
static int be_stopped(void)
{
    void *state = NULL;
    if (setup(&state)) {
        return 2;
    }
    struct rig *rig = state;
    rig->config.sensor.stale_ms = 1000;
    start(rig);
    slow_disk_stop_process();
    const bool denied = strstr(come(rig), "visit deny anna ") != NULL;
    iso_appliance_stop(rig->appliance);
    const bool moved = wired_door_switchings(ISO_DOOR_RELAY) > 0;
    return teardown(&state) ? 3 : denied && !moved ? 0 : 1;
}

static void a_stopped_process_lets_nobody_in_when_it_goes_on(void **state)
{
    const struct timespec stopped = {.tv_sec = STOPPED_S};
    int status = 0;
    (void)state;
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        _exit(be_stopped());
    }
    assert_int_equal(waitpid(child, &status, WUNTRACED), child);
    assert_true(WIFSTOPPED(status));
    (void)nanosleep(&stopped, NULL);
    assert_int_equal(kill(child, SIGCONT), 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

int main(void)
{
#define TEST(f)      cmocka_unit_test_setup_teardown(f, setup, teardown)
#define TEST_SAFE(f) cmocka_unit_test_setup_teardown(f, setup_fail_safe, teardown)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stopped_process_lets_nobody_in_when_it_goes_on),
        TEST(whoever_is_known_is_let_in_while_the_disk_works),
        TEST(relay_and_exit_do_not_wait_for_the_disk),
        TEST(contact_and_tamper_do_not_wait_for_the_disk),
        TEST(a_grant_that_is_not_on_record_lets_nobody_in),
        TEST(a_grant_that_was_not_begun_is_forgotten),
        TEST(a_full_queue_lets_nobody_in),
        TEST(a_chattering_contact_keeps_nobody_out),
        TEST(a_stuck_journal_keeps_nobody_out),
        TEST(administration_does_not_keep_the_door_waiting),
        TEST(the_exit_button_works_before_the_start_is_on_record),
        TEST(a_door_that_works_already_is_taken_over),
        TEST_SAFE(a_slow_disk_does_not_release_a_fail_safe_door),
        TEST_SAFE(frames_from_before_a_stall_let_nobody_in),
        TEST_SAFE(a_dead_sensor_is_a_fault_behind_a_stall),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
