#include "drivers/door/wiegand_out.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <time.h>

#include "drivers/base/times.h"
#include "drivers/process/thread.h"

struct iso_wiegand_out {
    struct iso_wiegand_lines lines;
    pthread_t thread;
    pthread_mutex_t mutex; /* protects all members below */
    pthread_cond_t changed;
    bool busy, end;
    uint64_t code;
    int bits;
    int error; /* the error of the last code */
    struct iso_wiegand_report report;
};

/* ---- the thread ---- */

static void sleep_until(int64_t t_ns)
{
    const struct timespec until = {t_ns / 1000000000, t_ns % 1000000000};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL) == EINTR) {
    }
}

/* Waits without sleeping: a pulse is so short that waking up would take as long. */
static void spin_until(int64_t t_ns)
{
    while (iso_monotonic_ns() < t_ns) {
    }
}

static void widen_range(int64_t *min_ns, int64_t *max_ns, int64_t ns)
{
    *min_ns = *min_ns == 0 || ns < *min_ns ? ns : *min_ns;
    *max_ns = ns > *max_ns ? ns : *max_ns;
}

/* The length of a pulse counts from the moment at which the line has its level, so that an
 * interruption before that cannot shorten the pulse. */
static int send_pulse(const struct iso_wiegand_lines *lines, int line, int64_t *begin_ns,
                      struct iso_wiegand_report *report)
{
    const int error = lines->set(lines->context, line, true);
    *begin_ns = iso_monotonic_ns();
    spin_until(*begin_ns + ISO_WIEGAND_PULSE_NS);
    const int rest_error = lines->set(lines->context, line, false);
    if (!error && !rest_error) {
        report->pulses++;
        widen_range(&report->pulse_min_ns, &report->pulse_max_ns, iso_monotonic_ns() - *begin_ns);
    }
    return error ? error : rest_error;
}

static bool has_to_end(struct iso_wiegand_out *out)
{
    (void)pthread_mutex_lock(&out->mutex);
    const bool end = out->end;
    (void)pthread_mutex_unlock(&out->mutex);
    return end;
}

/* Each pulse is due one interval after the actual start of the previous pulse. The interval is kept
 * even if the previous pulse was late. */
static int send_code(struct iso_wiegand_out *out, uint64_t code, int bits,
                     struct iso_wiegand_report *report)
{
    int64_t due_ns = iso_monotonic_ns(), before_ns = 0, begin_ns;
    for (int bit = bits - 1; bit >= 0; bit--) {
        sleep_until(due_ns);
        if (has_to_end(out)) {
            return -ECANCELED;
        }
        const int error = send_pulse(&out->lines, (int)(code >> bit & 1), &begin_ns, report);
        if (error) {
            return error;
        }
        if (before_ns) {
            widen_range(&report->interval_min_ns, &report->interval_max_ns, begin_ns - before_ns);
        }
        before_ns = begin_ns;
        due_ns = begin_ns + ISO_WIEGAND_INTERVAL_NS;
    }
    report->codes++;
    /* The next code must not begin before the interval after the last pulse has passed. */
    sleep_until(due_ns);
    return 0;
}

static void *run_sender(void *context)
{
    struct iso_wiegand_out *out = context;
    iso_thread_set_name("isothermd-card");
    (void)prctl(PR_SET_TIMERSLACK, 1UL);
    (void)pthread_mutex_lock(&out->mutex);
    while (!out->end) {
        if (!out->busy) {
            (void)pthread_cond_wait(&out->changed, &out->mutex);
            continue;
        }
        struct iso_wiegand_report report = out->report;
        (void)pthread_mutex_unlock(&out->mutex);
        const int error = send_code(out, out->code, out->bits, &report);
        (void)pthread_mutex_lock(&out->mutex);
        out->report = report;
        out->error = error;
        out->busy = false;
        (void)pthread_cond_broadcast(&out->changed);
    }
    (void)pthread_mutex_unlock(&out->mutex);
    return NULL;
}

/* ---- its owner ---- */

int iso_wiegand_out_new(const struct iso_wiegand_lines *lines, struct iso_wiegand_out **out,
                        struct iso_fault *fault)
{
    struct iso_wiegand_out *new = calloc(1, sizeof *new);
    if (!new) {
        return iso_fault_set(fault, -ENOMEM, "wiegand: out of memory");
    }
    new->lines = *lines;
    iso_thread_mutex_init(&new->mutex);
    (void)pthread_cond_init(&new->changed, NULL);
    const int error = iso_thread_start_realtime(&new->thread, run_sender, new, ISO_WIEGAND_PRIORITY,
                                                &new->report.realtime);
    if (error) {
        free(new);
        return iso_fault_set(fault, error, "wiegand: no thread: %s", strerror(-error));
    }
    *out = new;
    return 0;
}

void iso_wiegand_out_free(struct iso_wiegand_out *out)
{
    if (out) {
        (void)pthread_mutex_lock(&out->mutex);
        out->end = true;
        (void)pthread_cond_broadcast(&out->changed);
        (void)pthread_mutex_unlock(&out->mutex);
        (void)pthread_join(out->thread, NULL);
        (void)pthread_cond_destroy(&out->changed);
        (void)pthread_mutex_destroy(&out->mutex);
        free(out);
    }
}

/* Returns the error of the last code once. The mutex is held. */
static int take_error(struct iso_wiegand_out *out)
{
    const int error = out->error;
    out->error = 0;
    return error;
}

int iso_wiegand_out_send(struct iso_wiegand_out *out, uint64_t code, int bits)
{
    (void)pthread_mutex_lock(&out->mutex);
    const int error = out->busy ? -EBUSY : take_error(out);
    if (!error) {
        out->code = code;
        out->bits = bits;
        out->busy = true;
        (void)pthread_cond_broadcast(&out->changed);
    }
    (void)pthread_mutex_unlock(&out->mutex);
    return error;
}

int iso_wiegand_out_flush(struct iso_wiegand_out *out)
{
    (void)pthread_mutex_lock(&out->mutex);
    while (out->busy) {
        (void)pthread_cond_wait(&out->changed, &out->mutex);
    }
    const int error = take_error(out);
    (void)pthread_mutex_unlock(&out->mutex);
    return error;
}

void iso_wiegand_out_report(struct iso_wiegand_out *out, struct iso_wiegand_report *report)
{
    (void)pthread_mutex_lock(&out->mutex);
    *report = out->report;
    (void)pthread_mutex_unlock(&out->mutex);
}
