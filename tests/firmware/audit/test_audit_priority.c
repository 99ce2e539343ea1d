/* A thread of real-time priority posts a record, as the door's thread does. It does not wait for
 * the log's thread, which has no such priority and gets no processor time while threads of higher
 * priority are busy. */
#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/audit/audit_writer.h"
#include "tests/firmware/rigs/audit_rig.h"
#include "tests/support/scratch.h"

/* Priorities, and the time for which no thread below the priority BUSY runs. */
enum { ORDINARY, BUSY, APPENDER, DOOR, BUSY_MS = 300, MOMENT_MS = 20, ROUNDS = 3 };

static struct iso_audit *audit;
static struct iso_audit_writer *writer;
static struct iso_times times;
static cpu_set_t all;
static atomic_bool posted;

/* ---- one processor, and priorities on it ---- */

/* Returns false if the process may not use real-time priorities. */
static bool set_priority(int priority)
{
    const struct sched_param parameters = {.sched_priority = priority};
    return sched_setscheduler(0, priority == ORDINARY ? SCHED_OTHER : SCHED_FIFO, &parameters) == 0;
}

static void take_one_processor(void)
{
    cpu_set_t one;
    unsigned processor = 0;
    assert_int_equal(sched_getaffinity(0, sizeof all, &all), 0);
    while (!CPU_ISSET(processor, &all)) {
        processor++;
    }
    CPU_ZERO(&one);
    CPU_SET(processor, &one);
    assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
}

static pthread_t start_thread(void *(*run)(void *context))
{
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, run, NULL), 0);
    return thread;
}

static void wait_a_moment(void)
{
    const struct timespec moment = {.tv_nsec = MOMENT_MS * 1000000L};
    (void)nanosleep(&moment, NULL);
}

static int setup(void **state)
{
    if (stores_setup(state)) {
        return -1;
    }
    take_one_processor();
    audit = audit_rig_open(*state);
    times = iso_times_system();
    return iso_audit_writer_new(audit, &times, true, &writer);
}

static int teardown(void **state)
{
    (void)set_priority(ORDINARY);
    (void)sched_setaffinity(0, sizeof all, &all);
    iso_audit_writer_free(writer);
    iso_audit_close(audit);
    return stores_teardown(state);
}

/* ---- threads ---- */

/* Keeps the processor busy until the record is posted, or for BUSY_MS. In the second case the
 * result is not NULL. */
static void *be_busy(void *context)
{
    (void)context;
    (void)set_priority(BUSY);
    const int64_t end_ns = iso_times_now_ns(&times) + BUSY_MS * ISO_NS_PER_MS;
    while (!posted) {
        if (iso_times_now_ns(&times) > end_ns) {
            return &posted;
        }
    }
    return NULL;
}

/* Wakes the log's thread and waits for it. */
static void *append(void *context)
{
    const struct iso_audit_record record = iso_audit_record_of("grant");
    (void)context;
    (void)set_priority(APPENDER);
    (void)!iso_audit_writer_append(writer, &record, ISO_NEVER_NS, NULL, NULL);
    return NULL;
}

static void a_post_does_not_wait_for_the_thread_that_it_wakes(void **state)
{
    const struct iso_audit_record record = iso_audit_record_of("door");
    (void)state;
    if (!set_priority(DOOR)) {
        print_message("no right to real-time priorities: %s\n", strerror(errno));
        skip();
    }
    for (int i = 0; i < ROUNDS; i++) {
        void *too_long = NULL;
        wait_a_moment(); /* the log's thread waits for work */
        posted = false;
        const pthread_t busy = start_thread(be_busy);
        const pthread_t appender = start_thread(append);
        wait_a_moment(); /* it waits for the log's thread */
        const int error = iso_audit_writer_post(writer, &record, NULL);
        posted = true;
        assert_int_equal(pthread_join(busy, &too_long), 0);
        assert_int_equal(pthread_join(appender, NULL), 0);
        assert_int_equal(error, 0);
        assert_null(too_long);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_post_does_not_wait_for_the_thread_that_it_wakes, setup,
                                        teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
