/* Finding the threads that an act started, and waiting until they sleep. */
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/sensor/openni2/openni2_player.h"

enum { BUSY_STEPS = 2000000 };

struct worker {
    pthread_t thread;
    int wake[2]; /* a byte here ends the thread's sleep */
    atomic_bool begun, go, done;
};

/* Is busy until it may go on, then a little longer, and sleeps at last. */
static void *work(void *context)
{
    struct worker *worker = context;
    volatile long steps = 0;
    char byte;
    atomic_store(&worker->begun, true);
    while (!atomic_load(&worker->go)) {
    }
    while (steps < BUSY_STEPS) {
        steps = steps + 1;
    }
    atomic_store(&worker->done, true);
    (void)!read(worker->wake[0], &byte, 1);
    return NULL;
}

static void start(struct worker *worker)
{
    *worker = (struct worker){.wake = {-1, -1}};
    assert_int_equal(pipe(worker->wake), 0);
    assert_int_equal(pthread_create(&worker->thread, NULL, work, worker), 0);
}

/* Starts a worker. fresh: the threads that have come with it. */
static void start_alone(struct worker *worker, struct iso__openni2_threads *fresh)
{
    struct iso__openni2_threads before;
    iso__openni2_threads_list(&before);
    start(worker);
    iso__openni2_threads_new(&before, fresh);
}

static void end(struct worker *worker)
{
    assert_int_equal(write(worker->wake[1], "", 1), 1);
    assert_int_equal(pthread_join(worker->thread, NULL), 0);
    (void)close(worker->wake[0]);
    (void)close(worker->wake[1]);
}

static void only_new_threads_are_found(void **state)
{
    struct iso__openni2_threads before, fresh;
    struct worker old, young;
    (void)state;
    start(&old);
    iso__openni2_threads_list(&before);
    assert_true(before.n >= 2); /* this one and the old one */
    iso__openni2_threads_new(&before, &fresh);
    assert_int_equal(fresh.n, 0);
    start(&young);
    iso__openni2_threads_new(&before, &fresh);
    assert_int_equal(fresh.n, 1);
    for (int i = 0; i < before.n; i++) {
        assert_int_not_equal(fresh.ids[0], before.ids[i]);
    }
    atomic_store(&old.go, true);
    atomic_store(&young.go, true);
    end(&young);
    end(&old);
}

static void a_busy_thread_is_waited_for(void **state)
{
    struct iso__openni2_threads fresh;
    struct worker worker;
    (void)state;
    start_alone(&worker, &fresh);
    while (!atomic_load(&worker.begun)) {
    }
    atomic_store(&worker.go, true);
    iso__openni2_threads_await_sleep(&fresh);
    assert_true(atomic_load(&worker.done));
    iso__openni2_threads_await_sleep(&fresh); /* a thread that sleeps already */
    end(&worker);
    iso__openni2_threads_await_sleep(&fresh); /* a thread that has ended */
}

static void a_thread_that_never_sleeps_is_given_up(void **state)
{
    struct timespec begin, end_of_wait;
    struct iso__openni2_threads fresh;
    struct worker worker;
    (void)state;
    start_alone(&worker, &fresh);
    (void)clock_gettime(CLOCK_MONOTONIC, &begin);
    iso__openni2_threads_await_sleep(&fresh);
    (void)clock_gettime(CLOCK_MONOTONIC, &end_of_wait);
    assert_true(1e3 * (double)(end_of_wait.tv_sec - begin.tv_sec) +
                    1e-6 * (double)(end_of_wait.tv_nsec - begin.tv_nsec) >
                450);
    assert_false(atomic_load(&worker.done));
    atomic_store(&worker.go, true);
    end(&worker);
}

static void without_a_list_nothing_is_new(void **state)
{
    const struct iso__openni2_threads none = {.n = 0};
    struct iso__openni2_threads fresh;
    (void)state;
    iso__openni2_threads_new(&none, &fresh);
    assert_int_equal(fresh.n, 0);
    iso__openni2_threads_await_sleep(&none);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_new_threads_are_found),
        cmocka_unit_test(a_busy_thread_is_waited_for),
        cmocka_unit_test(a_thread_that_never_sleeps_is_given_up),
        cmocka_unit_test(without_a_list_nothing_is_new),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
