#include "firmware/door/door_guard.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "drivers/base/times.h"
#include "drivers/process/thread.h"

struct iso_door_guard {
    struct iso_door_guard_options options;
    pthread_t thread;
    bool running;          /* the thread has been started */
    bool ordinary;         /* the thread has no real-time priority */
    int wake_fd;           /* wakes the thread; -1 without one */
    int timer_fd;          /* readable when a time is due */
    int news_fd;           /* readable while there is news */
    pthread_mutex_t mutex; /* protects all members below, and the door's lines */
    struct iso_door_control control;
    int64_t granted_until_ns; /* the limit of the last grant */
    bool ending;
    struct iso_door_news news[ISO_DOOR_GUARD_NEWS]; /* a ring buffer */
    size_t first, n, missed;
};

static int64_t now_ns(const struct iso_door_guard *guard)
{
    return iso_clock_now_ns(&guard->options.clock);
}

static void make_readable(int fd)
{
    const uint64_t one = 1;
    (void)!write(fd, &one, sizeof one);
}

static void make_quiet(int fd)
{
    uint64_t count;
    (void)!read(fd, &count, sizeof count);
}

/* ---- news ---- */

static void on_changed(void *context, enum iso_door_event cause)
{
    struct iso_door_guard *guard = context;
    const struct iso_door_control *control = &guard->control;
    if (guard->n == ISO_DOOR_GUARD_NEWS) {
        guard->first = (guard->first + 1) % ISO_DOOR_GUARD_NEWS;
        guard->n--;
        guard->missed++;
    }
    struct iso_door_news *news = &guard->news[(guard->first + guard->n) % ISO_DOOR_GUARD_NEWS];
    *news = (struct iso_door_news){
        .t_ns = now_ns(guard),
        .cause = cause,
        .state = control->door.state,
        .tamper = control->door.tamper,
    };
    if (control->broken) {
        news->fault = control->fault;
    }
    guard->n++;
    if (guard->options.record) {
        guard->options.record(guard->options.context, news);
    }
    if (guard->options.threaded) {
        make_readable(guard->news_fd);
    }
}

size_t iso_door_guard_attach(struct iso_door_guard *guard,
                             void (*record)(void *context, const struct iso_door_news *news),
                             void *context)
{
    (void)pthread_mutex_lock(&guard->mutex);
    const size_t missing = guard->missed;
    for (size_t i = 0; i < guard->n; i++) {
        record(context, &guard->news[(guard->first + i) % ISO_DOOR_GUARD_NEWS]);
    }
    guard->options.record = record;
    guard->options.context = context;
    (void)pthread_mutex_unlock(&guard->mutex);
    return missing;
}

void iso_door_guard_detach(struct iso_door_guard *guard)
{
    if (guard) {
        (void)pthread_mutex_lock(&guard->mutex);
        guard->options.record = NULL;
        (void)pthread_mutex_unlock(&guard->mutex);
    }
}

bool iso_door_guard_next(struct iso_door_guard *guard, struct iso_door_news *news, size_t *missed)
{
    (void)pthread_mutex_lock(&guard->mutex);
    const bool there = guard->n > 0;
    if (there) {
        *news = guard->news[guard->first];
        guard->first = (guard->first + 1) % ISO_DOOR_GUARD_NEWS;
        guard->n--;
    } else if (guard->options.threaded) {
        make_quiet(guard->news_fd);
    }
    *missed = guard->missed;
    guard->missed = 0;
    (void)pthread_mutex_unlock(&guard->mutex);
    return there;
}

/* ---- the thread ---- */

/* Steps the door; the mutex is held. */
static void step_door(struct iso_door_guard *guard)
{
    const int fd = iso_door_io_poll_fd(guard->options.io);
    iso_door_control_step(&guard->control, fd >= 0, now_ns(guard));
}

/* Without a timer the thread steps the door at this interval. */
static const int blind_ms = 5;

/* A time that has passed is due at once; a time of 0 would disarm the timer. Returns false if there
 * is no timer. */
static bool arm_timer(const struct iso_door_guard *guard, int64_t due_ns)
{
    struct itimerspec when = {.it_value.tv_sec = 0};
    if (due_ns != ISO_NEVER_NS) {
        const int64_t at_ns = due_ns > 0 ? due_ns : 1;
        when.it_value.tv_sec = (time_t)(at_ns / ISO_NS_PER_S);
        when.it_value.tv_nsec = (long)(at_ns % ISO_NS_PER_S);
    }
    return timerfd_settime(guard->timer_fd, TFD_TIMER_ABSTIME, &when, NULL) == 0;
}

/* Waits for an edge of the lines, for the time that is due, or until it is woken. The descriptor of
 * lines that do not work may stay readable; the caller then passes -1, and reads the lines by time
 * only. */
static void wait_for_something(const struct iso_door_guard *guard, int lines_fd, int64_t due_ns)
{
    struct pollfd ready[] = {
        {.fd = guard->wake_fd, .events = POLLIN},
        {.fd = guard->timer_fd, .events = POLLIN},
        {.fd = lines_fd, .events = POLLIN},
    };
    const bool armed = arm_timer(guard, due_ns);
    (void)poll(ready, sizeof ready / sizeof *ready, armed ? -1 : blind_ms);
    make_quiet(guard->wake_fd);
    make_quiet(guard->timer_fd);
}

static void *run_guard(void *context)
{
    struct iso_door_guard *guard = context;
    iso_thread_set_name("isothermd-door");
    (void)prctl(PR_SET_TIMERSLACK, 1UL);
    (void)pthread_mutex_lock(&guard->mutex);
    while (!guard->ending) {
        step_door(guard);
        const int64_t due_ns = iso_door_control_due_ns(&guard->control);
        const int lines_fd = guard->control.broken ? -1 : iso_door_io_poll_fd(guard->options.io);
        (void)pthread_mutex_unlock(&guard->mutex);
        wait_for_something(guard, lines_fd, due_ns);
        (void)pthread_mutex_lock(&guard->mutex);
    }
    (void)pthread_mutex_unlock(&guard->mutex);
    return NULL;
}

/* ---- new, start, stop, free ---- */

static int open_descriptors(struct iso_door_guard *guard)
{
    guard->wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    guard->news_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    guard->timer_fd = timerfd_create(CLOCK_BOOTTIME, TFD_CLOEXEC | TFD_NONBLOCK);
    return guard->wake_fd < 0 || guard->news_fd < 0 || guard->timer_fd < 0 ? -errno : 0;
}

int iso_door_guard_new(const struct iso_door_guard_options *options, struct iso_door_guard **out)
{
    struct iso_door_guard *guard = calloc(1, sizeof *guard);
    if (!guard) {
        return -ENOMEM;
    }
    guard->options = *options;
    guard->wake_fd = guard->timer_fd = guard->news_fd = -1;
    iso_thread_mutex_init(&guard->mutex);
    iso_door_control_init(&guard->control, &options->door, &options->timing, options->io,
                          on_changed, guard);
    const int error = options->threaded ? open_descriptors(guard) : 0;
    if (error) {
        iso_door_guard_free(guard);
        return error;
    }
    *out = guard;
    return 0;
}

static void close_descriptor(int fd)
{
    if (fd >= 0) {
        (void)close(fd);
    }
}

void iso_door_guard_free(struct iso_door_guard *guard)
{
    if (!guard) {
        return;
    }
    if (guard->running) {
        (void)pthread_mutex_lock(&guard->mutex);
        guard->ending = true;
        (void)pthread_mutex_unlock(&guard->mutex);
        make_readable(guard->wake_fd);
        (void)pthread_join(guard->thread, NULL);
    }
    close_descriptor(guard->wake_fd);
    close_descriptor(guard->timer_fd);
    close_descriptor(guard->news_fd);
    (void)pthread_mutex_destroy(&guard->mutex);
    free(guard);
}

int iso_door_guard_start(struct iso_door_guard *guard)
{
    (void)pthread_mutex_lock(&guard->mutex);
    iso_door_control_start(&guard->control, now_ns(guard));
    (void)pthread_mutex_unlock(&guard->mutex);
    if (!guard->options.threaded) {
        return 0;
    }
    bool realtime = false;
    const int error = iso_thread_start_realtime(&guard->thread, run_guard, guard,
                                                ISO_DOOR_GUARD_PRIORITY, &realtime);
    guard->running = error == 0;
    guard->ordinary = !realtime;
    return error;
}

/* ---- calls ---- */

/* Called after an operation that may have changed the next due time. */
static void unlock_and_wake(struct iso_door_guard *guard)
{
    (void)pthread_mutex_unlock(&guard->mutex);
    if (guard->options.threaded) {
        make_readable(guard->wake_fd);
    }
}

void iso_door_guard_stop(struct iso_door_guard *guard)
{
    (void)pthread_mutex_lock(&guard->mutex);
    iso_door_control_stop(&guard->control, now_ns(guard));
    guard->ending = true;
    unlock_and_wake(guard);
}

/* The time is checked again after the switching, because the process may have been stopped just
 * before it. If something else, such as the exit button, has unlocked the door, it stays
 * unlocked. */
static int grant_entry(struct iso_door_guard *guard, int64_t until_ns, enum iso_door_answer *answer)
{
    struct iso_door_control *control = &guard->control;
    const int64_t begin_ns = now_ns(guard);
    const bool was_unlocked = control->door.state == ISO_DOOR_UNLOCKED;
    if (begin_ns > until_ns) {
        return -ESTALE;
    }
    const enum iso_door_answer did = iso_door_control_grant(control, begin_ns);
    if (did == ISO_DOOR_DID_UNLOCK && !was_unlocked && now_ns(guard) > until_ns) {
        iso_door_control_withdraw(control, now_ns(guard));
        return -ESTALE;
    }
    *answer = did;
    guard->granted_until_ns = until_ns;
    return 0;
}

int iso_door_guard_grant(struct iso_door_guard *guard, int64_t until_ns,
                         enum iso_door_answer *answer)
{
    (void)pthread_mutex_lock(&guard->mutex);
    const int error = grant_entry(guard, until_ns, answer);
    unlock_and_wake(guard);
    return error;
}

void iso_door_guard_refuse(struct iso_door_guard *guard)
{
    (void)pthread_mutex_lock(&guard->mutex);
    iso_door_control_refuse(&guard->control, now_ns(guard));
    unlock_and_wake(guard);
}

int iso_door_guard_test(struct iso_door_guard *guard, struct iso_fault *fault)
{
    (void)pthread_mutex_lock(&guard->mutex);
    const int error = iso_door_control_test(&guard->control, now_ns(guard), fault);
    unlock_and_wake(guard);
    return error;
}

int iso_door_guard_may_test(struct iso_door_guard *guard, struct iso_fault *fault)
{
    (void)pthread_mutex_lock(&guard->mutex);
    const int error = iso_door_control_may_test(&guard->control, fault);
    (void)pthread_mutex_unlock(&guard->mutex);
    return error;
}

void iso_door_guard_set_fault(struct iso_door_guard *guard, bool fault)
{
    (void)pthread_mutex_lock(&guard->mutex);
    iso_door_control_set_fault(&guard->control, fault, now_ns(guard));
    unlock_and_wake(guard);
}

void iso_door_guard_show(struct iso_door_guard *guard, const struct iso_door_lamps *lamps)
{
    (void)pthread_mutex_lock(&guard->mutex);
    iso_door_control_show(&guard->control, lamps, now_ns(guard));
    unlock_and_wake(guard);
}

void iso_door_guard_set_times(struct iso_door_guard *guard, const struct iso_door_options *times)
{
    (void)pthread_mutex_lock(&guard->mutex);
    guard->control.door.options.unlock_ns = times->unlock_ns;
    guard->control.door.options.held_ns = times->held_ns;
    guard->control.door.options.refused_ns = times->refused_ns;
    (void)pthread_mutex_unlock(&guard->mutex);
}

int iso_door_guard_send_card(struct iso_door_guard *guard, const struct iso_wiegand_card *card,
                             struct iso_fault *fault)
{
    int error = -EACCES;
    (void)pthread_mutex_lock(&guard->mutex);
    if (guard->control.door.state == ISO_DOOR_UNLOCKED) {
        error = now_ns(guard) <= guard->granted_until_ns
                    ? iso_door_io_send_card(guard->options.io, card, fault)
                    : iso_fault_set(fault, -ESTALE, "the verdict is too old to send the card");
    }
    (void)pthread_mutex_unlock(&guard->mutex);
    return error;
}

struct iso_door_look iso_door_guard_look(struct iso_door_guard *guard)
{
    struct iso_door_look look = {.fault = {.text = ""}};
    (void)pthread_mutex_lock(&guard->mutex);
    look.state = guard->control.door.state;
    look.tamper = guard->control.door.tamper;
    look.ordinary = guard->ordinary;
    if (guard->control.broken) {
        look.fault = guard->control.fault;
    }
    (void)pthread_mutex_unlock(&guard->mutex);
    return look;
}

int iso_door_guard_fd(struct iso_door_guard *guard)
{
    if (guard->options.threaded) {
        return guard->news_fd;
    }
    return iso_door_io_poll_fd(guard->options.io);
}

void iso_door_guard_step(struct iso_door_guard *guard)
{
    if (!guard->options.threaded) {
        (void)pthread_mutex_lock(&guard->mutex);
        step_door(guard);
        (void)pthread_mutex_unlock(&guard->mutex);
    }
}

int64_t iso_door_guard_due_ns(struct iso_door_guard *guard)
{
    if (guard->options.threaded) {
        return ISO_NEVER_NS;
    }
    (void)pthread_mutex_lock(&guard->mutex);
    const int64_t due_ns = iso_door_control_due_ns(&guard->control);
    (void)pthread_mutex_unlock(&guard->mutex);
    return due_ns;
}
