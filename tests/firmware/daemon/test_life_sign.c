/* The notifications for the service manager while the main thread waits for the disk. Each test
 * waits for the notifications that must come, and checks that no others have come. */
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "drivers/file/disk_wait.h"
#include "firmware/daemon/life_sign.h"

static struct iso_life_sign *sign;
static atomic_int extended, fed, others;

static void send(void *context, const char *text)
{
    (void)context;
    if (strcmp(text, "WATCHDOG=1") == 0) {
        atomic_fetch_add(&fed, 1);
    } else if (strncmp(text, "EXTEND_TIMEOUT_USEC=", strlen("EXTEND_TIMEOUT_USEC=")) == 0) {
        atomic_fetch_add(&extended, 1);
    } else {
        atomic_fetch_add(&others, 1);
    }
}

static void begin(int64_t limit_ns, bool watchdog)
{
    const struct iso_life_sign_options options = {
        .tick_ns = ISO_NS_PER_MS, .limit_ns = limit_ns, .watchdog = watchdog, .send = send};
    atomic_store(&extended, 0);
    atomic_store(&fed, 0);
    atomic_store(&others, 0);
    assert_int_equal(iso_life_sign_new(&options, &sign), 0);
}

static int teardown(void **state)
{
    (void)state;
    iso_life_sign_free(sign);
    sign = NULL;
    return atomic_load(&others);
}

static void wait_ms(long ms)
{
    const struct timespec wait = {.tv_nsec = ms * 1000000L};
    (void)nanosleep(&wait, NULL);
}

/* Waits for three more notifications of this kind. The time-out of the test ends this wait if they
 * never come. */
static void await(atomic_int *count)
{
    const int before = atomic_load(count);
    while (atomic_load(count) < before + 3) {
        wait_ms(1);
    }
}

static void it_notifies_during_a_wait_for_the_disk(void **state)
{
    (void)state;
    begin(3600 * ISO_NS_PER_S, true);
    iso_disk_wait_begin();
    await(&extended); /* the start */
    assert_int_equal(atomic_load(&fed), 0);
    iso_life_sign_enter(sign, ISO_LIFE_RUNNING);
    await(&fed);
    iso_life_sign_enter(sign, ISO_LIFE_STOPPING);
    await(&extended);
    iso_disk_wait_end();
}

/* A main thread that hangs elsewhere must be found by the watchdog. */
static void it_sends_nothing_otherwise(void **state)
{
    (void)state;
    begin(3600 * ISO_NS_PER_S, true);
    wait_ms(20);
    iso_life_sign_enter(sign, ISO_LIFE_RUNNING);
    wait_ms(20);
    iso_disk_wait_begin();
    iso_disk_wait_begin();
    iso_disk_wait_end();
    assert_true(iso_disk_wait_lasts()); /* the waits are nested */
    iso_disk_wait_end();
    assert_false(iso_disk_wait_lasts());
    iso_life_sign_free(sign); /* no wait is under way any more */
    sign = NULL;
    assert_int_equal(atomic_load(&extended), 0);
    assert_true(atomic_load(&fed) <= 1); /* from the moment between begin and end */
}

static void *wait_elsewhere(void *context)
{
    bool *lasted = context;
    iso_disk_wait_begin();
    *lasted = iso_disk_wait_lasts();
    wait_ms(20);
    iso_disk_wait_end();
    return NULL;
}

/* The thread of the log may wait for any time. */
static void another_thread_does_not_count(void **state)
{
    pthread_t thread;
    bool lasted = true;
    (void)state;
    begin(3600 * ISO_NS_PER_S, true);
    assert_int_equal(pthread_create(&thread, NULL, wait_elsewhere, &lasted), 0);
    assert_int_equal(pthread_join(thread, NULL), 0);
    assert_false(lasted);
    iso_life_sign_free(sign);
    sign = NULL;
    assert_int_equal(atomic_load(&extended) + atomic_load(&fed), 0);
}

/* A disk that never answers becomes a fault in the end. */
static void it_notifies_for_a_limited_time(void **state)
{
    (void)state;
    begin(0, true);
    iso_disk_wait_begin();
    wait_ms(20);
    iso_life_sign_enter(sign, ISO_LIFE_RUNNING);
    wait_ms(20);
    iso_life_sign_renew(sign);
    wait_ms(20);
    iso_life_sign_free(sign);
    sign = NULL;
    iso_disk_wait_end();
    assert_int_equal(atomic_load(&extended) + atomic_load(&fed), 0);
}

static void without_a_watchdog_nothing_is_fed(void **state)
{
    (void)state;
    begin(3600 * ISO_NS_PER_S, false);
    iso_disk_wait_begin();
    await(&extended);
    iso_life_sign_enter(sign, ISO_LIFE_RUNNING);
    wait_ms(20);
    iso_life_sign_enter(sign, ISO_LIFE_STOPPING);
    await(&extended);
    iso_disk_wait_end();
    assert_int_equal(atomic_load(&fed), 0);
}

static void synchronising_is_a_wait_for_the_disk(void **state)
{
    (void)state;
    FILE *file = tmpfile();
    assert_non_null(file);
    assert_int_equal(iso_disk_wait_fsync(fileno(file)), 0);
    assert_int_equal(iso_disk_wait_fdatasync(fileno(file)), 0);
    assert_int_equal(iso_disk_wait_fsync(-1), -1);
    assert_false(iso_disk_wait_lasts());
    (void)fclose(file);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_teardown(f, teardown)
    const struct CMUnitTest tests[] = {
        TEST(it_notifies_during_a_wait_for_the_disk), TEST(it_sends_nothing_otherwise),
        TEST(another_thread_does_not_count),          TEST(it_notifies_for_a_limited_time),
        TEST(without_a_watchdog_nothing_is_fed),      TEST(synchronising_is_a_wait_for_the_disk),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
