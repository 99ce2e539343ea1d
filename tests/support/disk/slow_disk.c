#include "tests/support/disk/slow_disk.h"

#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>

#include <cmocka.h>

enum { PATIENCE_S = 60 };

static struct {
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    bool hangs, stops;
    int waiting, calls, takes_ms;
} disk = {.mutex = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};

int __wrap_fsync(int fd);
int __wrap_fdatasync(int fd);

static void set(bool hangs)
{
    (void)pthread_mutex_lock(&disk.mutex);
    disk.hangs = hangs;
    (void)pthread_cond_broadcast(&disk.changed);
    (void)pthread_mutex_unlock(&disk.mutex);
}

void slow_disk_hang(void)
{
    set(true);
}

void slow_disk_go_on(void)
{
    set(false);
}

void slow_disk_take_ms(int ms)
{
    (void)pthread_mutex_lock(&disk.mutex);
    disk.takes_ms = ms;
    (void)pthread_mutex_unlock(&disk.mutex);
}

int slow_disk_calls(void)
{
    (void)pthread_mutex_lock(&disk.mutex);
    const int calls = disk.calls;
    (void)pthread_mutex_unlock(&disk.mutex);
    return calls;
}

int slow_disk_waiting(void)
{
    (void)pthread_mutex_lock(&disk.mutex);
    const int waiting = disk.waiting;
    (void)pthread_mutex_unlock(&disk.mutex);
    return waiting;
}

void slow_disk_await(void)
{
    struct timespec until;
    int error = 0;
    (void)clock_gettime(CLOCK_REALTIME, &until);
    until.tv_sec += PATIENCE_S;
    (void)pthread_mutex_lock(&disk.mutex);
    while (disk.waiting == 0 && error == 0) {
        error = pthread_cond_timedwait(&disk.changed, &disk.mutex, &until);
    }
    const int waiting = disk.waiting;
    (void)pthread_mutex_unlock(&disk.mutex);
    assert_true(waiting > 0);
}

void slow_disk_stop_process(void)
{
    (void)pthread_mutex_lock(&disk.mutex);
    disk.stops = true;
    (void)pthread_mutex_unlock(&disk.mutex);
}

static void pass(void)
{
    (void)pthread_mutex_lock(&disk.mutex);
    const bool stops = disk.stops;
    const struct timespec takes = {.tv_nsec = disk.takes_ms * 1000000L};
    disk.stops = false;
    disk.calls++;
    disk.waiting++;
    (void)pthread_cond_broadcast(&disk.changed);
    while (disk.hangs) {
        (void)pthread_cond_wait(&disk.changed, &disk.mutex);
    }
    disk.waiting--;
    (void)pthread_mutex_unlock(&disk.mutex);
    if (takes.tv_nsec > 0) {
        (void)nanosleep(&takes, NULL);
    }
    if (stops) {
        (void)raise(SIGSTOP);
    }
}

int __wrap_fsync(int fd)
{
    (void)fd;
    pass();
    return 0;
}

int __wrap_fdatasync(int fd)
{
    (void)fd;
    pass();
    return 0;
}
