#include "firmware/daemon/life_sign.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <time.h>

#include "drivers/base/times.h"
#include "drivers/file/disk_wait.h"
#include "drivers/process/thread.h"

struct iso_life_sign {
    struct iso_life_sign_options options;
    pthread_t thread;
    pthread_mutex_t mutex; /* protects all members below; not held while a message is sent */
    pthread_cond_t changed;
    bool running, ending;
    enum iso_life_phase phase;
    int64_t renewed_ns; /* when the main thread last reported progress */
};

/* The message that is due now; NULL: none. Each message is valid for so long that the next one may
 * be missed. */
static const char *words(const struct iso_life_sign *sign)
{
    const bool speaks = iso_disk_wait_lasts() &&
                        iso_monotonic_ns() - sign->renewed_ns < sign->options.limit_ns;
    if (!speaks) {
        return NULL;
    }
    if (sign->phase != ISO_LIFE_RUNNING) {
        return "EXTEND_TIMEOUT_USEC=30000000";
    }
    return sign->options.watchdog ? "WATCHDOG=1" : NULL;
}

/* Waits for the next tick, or for the request to end. */
static void await_tick(struct iso_life_sign *sign)
{
    const int64_t t_ns = iso_monotonic_ns() + sign->options.tick_ns;
    const struct timespec until = {(time_t)(t_ns / ISO_NS_PER_S), (long)(t_ns % ISO_NS_PER_S)};
    int error = 0;
    while (!sign->ending && error != ETIMEDOUT) {
        error = pthread_cond_timedwait(&sign->changed, &sign->mutex, &until);
    }
}

static void *run(void *context)
{
    struct iso_life_sign *sign = context;
    iso_thread_set_name("isothermd-life");
    (void)pthread_mutex_lock(&sign->mutex);
    while (!sign->ending) {
        const char *text = words(sign);
        (void)pthread_mutex_unlock(&sign->mutex);
        if (text) {
            sign->options.send(sign->options.context, text);
        }
        (void)pthread_mutex_lock(&sign->mutex);
        await_tick(sign);
    }
    (void)pthread_mutex_unlock(&sign->mutex);
    return NULL;
}

int iso_life_sign_new(const struct iso_life_sign_options *options, struct iso_life_sign **out)
{
    pthread_condattr_t attributes;
    struct iso_life_sign *sign = calloc(1, sizeof *sign);
    if (!sign) {
        return -ENOMEM;
    }
    sign->options = *options;
    sign->renewed_ns = iso_monotonic_ns();
    iso_disk_wait_watch();
    (void)pthread_mutex_init(&sign->mutex, NULL);
    (void)pthread_condattr_init(&attributes);
    (void)pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    (void)pthread_cond_init(&sign->changed, &attributes);
    (void)pthread_condattr_destroy(&attributes);
    const int error = iso_thread_start(&sign->thread, run, sign);
    sign->running = error == 0;
    if (error) {
        iso_life_sign_free(sign);
        return error;
    }
    *out = sign;
    return 0;
}

void iso_life_sign_free(struct iso_life_sign *sign)
{
    if (!sign) {
        return;
    }
    if (sign->running) {
        (void)pthread_mutex_lock(&sign->mutex);
        sign->ending = true;
        (void)pthread_cond_broadcast(&sign->changed);
        (void)pthread_mutex_unlock(&sign->mutex);
        (void)pthread_join(sign->thread, NULL);
    }
    (void)pthread_cond_destroy(&sign->changed);
    (void)pthread_mutex_destroy(&sign->mutex);
    free(sign);
}

void iso_life_sign_enter(struct iso_life_sign *sign, enum iso_life_phase phase)
{
    if (sign) {
        (void)pthread_mutex_lock(&sign->mutex);
        sign->phase = phase;
        sign->renewed_ns = iso_monotonic_ns();
        (void)pthread_mutex_unlock(&sign->mutex);
    }
}

void iso_life_sign_renew(struct iso_life_sign *sign)
{
    if (sign) {
        (void)pthread_mutex_lock(&sign->mutex);
        sign->renewed_ns = iso_monotonic_ns();
        (void)pthread_mutex_unlock(&sign->mutex);
    }
}
