#include "firmware/keys/state_counter.h"

#include <errno.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdlib.h>
#include <time.h>

#include "drivers/process/thread.h"

/* The shortest time between two increments, by enum iso_state_change. */
static const int64_t waits_ns[] = {3600 * ISO_NS_PER_S, 1800 * ISO_NS_PER_S, 0};

/* How long the thread waits after a failure. */
enum { RETRY_S = 1, RETRY_MOST_S = 60 };

struct iso_state_counter {
    const struct iso_times *times;
    struct iso_counter device; /* only the thread uses it while it runs; otherwise the callers */
    pthread_t thread;
    bool threaded;
    pthread_mutex_t mutex; /* protects all members below; not held while the device works */
    pthread_cond_t changed;
    bool ending;
    bool begun;
    uint32_t found;    /* the number in the anchor as it was found, before the counter has begun */
    uint64_t value;    /* the value of the device */
    uint32_t written;  /* the number in the anchor on the disk */
    bool owed;         /* something has changed since the number was raised */
    int64_t wait_ns;   /* the longest time that this change may wait */
    int64_t raised_ns; /* the time at which the number was last raised */
    bool news;
    int error; /* of the last increment; 0: it succeeded */
    struct iso_fault fault;
};

int iso_state_counter_new(const struct iso_counter *counter, const struct iso_times *times,
                          struct iso_state_counter **out)
{
    struct iso_state_counter *own = calloc(1, sizeof *own);
    pthread_condattr_t attributes;
    if (!own) {
        return -ENOMEM;
    }
    own->times = times;
    own->device = *counter;
    (void)pthread_mutex_init(&own->mutex, NULL);
    (void)pthread_condattr_init(&attributes);
    (void)pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    (void)pthread_cond_init(&own->changed, &attributes);
    (void)pthread_condattr_destroy(&attributes);
    *out = own;
    return 0;
}

/* Notes a change. wait_ns is the shortest of the times that the changes may wait. The mutex is
 * held. */
static void owe_increment(struct iso_state_counter *counter, enum iso_state_change change)
{
    if (!counter->owed || waits_ns[change] < counter->wait_ns) {
        counter->wait_ns = waits_ns[change];
    }
    counter->owed = true;
}

/* ---- at the start ---- */

void iso_state_counter_found(struct iso_state_counter *counter, uint32_t number)
{
    (void)pthread_mutex_lock(&counter->mutex);
    if (!counter->begun) {
        counter->found = number;
    }
    (void)pthread_mutex_unlock(&counter->mutex);
}

/* Reads the counter. Returns 0 with *there false if the counter does not exist in the device. */
static int ask_device(struct iso_state_counter *counter, bool *there, uint64_t *value,
                      struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    const int error = counter->device.ops->read(counter->device.self, value, &why);
    *there = error == 0;
    if (error && error != -ENOENT) {
        return iso_fault_set_code(fault, why.code, error, "%s", why.text);
    }
    return *there && *value > ISO_STATE_COUNTER_MOST
               ? iso_fault_set_code(fault, ISO_FAULT_COUNTER_UNFIT, -ERANGE,
                                    "the counter of the state says %" PRIu64
                                    ", which is more than can be kept: take another one",
                                    *value)
               : 0;
}

static int judge_number(uint32_t found, uint64_t value, const char *path, struct iso_fault *fault)
{
    if (found == 0) {
        return iso_fault_set_code(
            fault, ISO_FAULT_STATE_OLD, -ESTALE,
            "%s: the state directory is new, or of an earlier time: it has no "
            "counter, the TPM says %" PRIu64 " (see --accept-state)",
            path, value);
    }
    if (found < value) {
        return iso_fault_set_code(fault, ISO_FAULT_STATE_OLD, -ESTALE,
                                  "%s: the state directory is of an earlier time: its counter says "
                                  "%" PRIu32 ", the TPM says %" PRIu64
                                  "; put the newest in its place (or see --accept-state)",
                                  path, found, value);
    }
    return found <= value + 1
               ? 0
               : iso_fault_set_code(fault, ISO_FAULT_COUNTER_OTHER, -ESTALE,
                                    "%s: the state directory belongs to another counter: "
                                    "it says %" PRIu32 ", the TPM says %" PRIu64
                                    " (see --accept-state)",
                                    path, found, value);
}

int iso_state_counter_check(struct iso_state_counter *counter, const char *path,
                            struct iso_fault *fault)
{
    bool there = false;
    uint64_t value = 0;
    const int error = ask_device(counter, &there, &value, fault);
    if (error) {
        return error;
    }
    if (there) {
        return judge_number(counter->found, value, path, fault);
    }
    return counter->found == 0
               ? 0
               : iso_fault_set_code(fault, ISO_FAULT_COUNTER_GONE, -ESTALE,
                                    "%s: the counter of the state is gone from the TPM: it has to "
                                    "be %" PRIu32 " (see --accept-state)",
                                    path, counter->found);
}

int iso_state_counter_begin(struct iso_state_counter *counter, struct iso_fault *fault)
{
    bool there = false;
    uint64_t value = 0;
    int error = ask_device(counter, &there, &value, fault);
    if (!error && !there) {
        error = counter->device.ops->define(counter->device.self, &value, fault);
    }
    if (error) {
        return error;
    }
    (void)pthread_mutex_lock(&counter->mutex);
    counter->begun = true;
    counter->value = value;
    counter->written = 0; /* the next anchor contains the number */
    owe_increment(counter, ISO_STATE_ADMINISTRATOR);
    (void)pthread_mutex_unlock(&counter->mutex);
    return 0;
}

/* ---- raising; the mutex is held ---- */

static bool is_behind(const struct iso_state_counter *counter)
{
    return counter->written > counter->value;
}

static bool is_due(const struct iso_state_counter *counter)
{
    return counter->begun && !is_behind(counter) && counter->owed &&
           iso_times_now_ns(counter->times) - counter->raised_ns >= counter->wait_ns;
}

static void note_result(struct iso_state_counter *counter, int error, const struct iso_fault *fault)
{
    if (error != counter->error || error) {
        counter->news = counter->news || error != counter->error;
        counter->error = error;
        counter->fault = *fault;
    }
}

/* The device is ahead of the anchor because another program has incremented it. A start would be
 * refused until the number in the anchor is raised. */
static void take_value(struct iso_state_counter *counter, uint64_t value)
{
    counter->value = value;
    if (counter->written < value) {
        owe_increment(counter, ISO_STATE_ADMINISTRATOR);
    }
}

/* Increments the device up to the number in the anchor. The device may have that number already, if
 * it was incremented but its answer was lost. A second increment would leave the anchor behind. */
static int reach_number(const struct iso_counter *device, uint32_t number, uint64_t *value,
                        struct iso_fault *fault)
{
    const int error = device->ops->read(device->self, value, fault);
    return error || *value >= number ? error : device->ops->increment(device->self, value, fault);
}

/* Increments the device. The mutex is held on entry and on return, but not while the device
 * works. */
static void increment_device(struct iso_state_counter *counter)
{
    struct iso_fault fault = {.text = ""};
    uint64_t value = 0;
    const uint32_t number = counter->written;
    (void)pthread_mutex_unlock(&counter->mutex);
    const int error = reach_number(&counter->device, number, &value, &fault);
    (void)pthread_mutex_lock(&counter->mutex);
    if (!error) {
        take_value(counter, value);
    }
    note_result(counter, error, &fault);
}

/* Waits for a change, but at most for so many seconds. */
static void wait_for(struct iso_state_counter *counter, int seconds)
{
    struct timespec until;
    (void)clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_sec += seconds;
    (void)pthread_cond_timedwait(&counter->changed, &counter->mutex, &until);
}

static void *run_thread(void *context)
{
    struct iso_state_counter *counter = context;
    iso_thread_set_name("isothermd-tpm");
    int wait_s = RETRY_S;
    (void)pthread_mutex_lock(&counter->mutex);
    while (!counter->ending) {
        if (!is_behind(counter)) {
            (void)pthread_cond_wait(&counter->changed, &counter->mutex);
            continue;
        }
        increment_device(counter);
        if (counter->error && !counter->ending) {
            wait_for(counter, wait_s);
            wait_s = 2 * wait_s < RETRY_MOST_S ? 2 * wait_s : RETRY_MOST_S;
        } else {
            wait_s = RETRY_S;
        }
    }
    (void)pthread_mutex_unlock(&counter->mutex);
    return NULL;
}

int iso_state_counter_start_thread(struct iso_state_counter *counter)
{
    const int error = iso_thread_start(&counter->thread, run_thread, counter);
    if (!error) {
        (void)pthread_mutex_lock(&counter->mutex);
        counter->threaded = true;
        (void)pthread_mutex_unlock(&counter->mutex);
    }
    return error;
}

void iso_state_counter_free(struct iso_state_counter *counter)
{
    if (!counter) {
        return;
    }
    if (counter->threaded) {
        (void)pthread_mutex_lock(&counter->mutex);
        counter->ending = true;
        (void)pthread_cond_broadcast(&counter->changed);
        (void)pthread_mutex_unlock(&counter->mutex);
        (void)pthread_join(counter->thread, NULL);
    }
    (void)pthread_mutex_lock(&counter->mutex);
    if (counter->begun && is_behind(counter)) {
        increment_device(counter);
    }
    (void)pthread_mutex_unlock(&counter->mutex);
    iso_counter_close(&counter->device);
    (void)pthread_cond_destroy(&counter->changed);
    (void)pthread_mutex_destroy(&counter->mutex);
    free(counter);
}

/* ---- when the log writes ---- */

void iso_state_counter_changed(struct iso_state_counter *counter, enum iso_state_change change)
{
    (void)pthread_mutex_lock(&counter->mutex);
    owe_increment(counter, change);
    (void)pthread_mutex_unlock(&counter->mutex);
}

bool iso_state_counter_is_due(struct iso_state_counter *counter)
{
    (void)pthread_mutex_lock(&counter->mutex);
    const bool due = is_due(counter);
    (void)pthread_mutex_unlock(&counter->mutex);
    return due;
}

uint32_t iso_state_counter_next(struct iso_state_counter *counter)
{
    (void)pthread_mutex_lock(&counter->mutex);
    uint32_t number = counter->found;
    if (counter->begun) {
        number = is_due(counter) ? (uint32_t)counter->value + 1 : counter->written;
    }
    (void)pthread_mutex_unlock(&counter->mutex);
    return number;
}

void iso_state_counter_wrote(struct iso_state_counter *counter, uint32_t number)
{
    (void)pthread_mutex_lock(&counter->mutex);
    if (counter->begun && number > counter->written) {
        counter->written = number;
        counter->owed = false;
        counter->raised_ns = iso_times_now_ns(counter->times);
        (void)pthread_cond_broadcast(&counter->changed);
    }
    if (counter->begun && !counter->threaded && is_behind(counter)) {
        increment_device(counter);
    }
    (void)pthread_mutex_unlock(&counter->mutex);
}

bool iso_state_counter_take_news(struct iso_state_counter *counter, int *error,
                                 struct iso_fault *fault)
{
    (void)pthread_mutex_lock(&counter->mutex);
    const bool news = counter->news;
    if (news) {
        *error = counter->error;
        *fault = counter->fault;
        counter->news = false;
    }
    (void)pthread_mutex_unlock(&counter->mutex);
    return news;
}
