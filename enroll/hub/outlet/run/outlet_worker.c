#include "enroll/hub/outlet/run/outlet_worker.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <systemd/sd-daemon.h>
#include <time.h>
#include <unistd.h>

#include "drivers/process/thread.h"
#include "enroll/hub/outlet/batch.h"
#include "enroll/hub/outlet/carry/carrier.h"
#include "enroll/hub/outlet/run/backoff.h"

enum { AT_ONCE = 0, END = -1 };

struct hub__worker {
    const struct hub_store_options *options;
    struct iso_fleet_id id;
    pthread_t thread;
    int stop_fd;

    /* of the thread */
    struct hub_store store;
    bool is_open;               /* the store */
    bool is_lost;               /* the database, or the row cannot be read: this was said */
    struct hub__outlet_row row; /* with which the carrier works; what changes is read anew */
    struct hub__carrier *carrier;
    struct iso_fleet_id handed; /* the batch that the receiver has, but the database may not know */
};

static int64_t now_ms(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_REALTIME, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* Says once that something does not work, and once that it works again. */
static int troubled(struct hub__worker *worker, int error, const struct iso_fault *fault)
{
    if (!error == worker->is_lost) {
        worker->is_lost = error;
        fprintf(stderr, "%sisotherm-hub: outlet %s: %s\n", error ? SD_WARNING : SD_INFO,
                *worker->row.outlet.name ? worker->row.outlet.name : "(not read yet)",
                error ? fault->text : "the database is there again");
    }
    return HUB__WORKER_TROUBLE_MS;
}

static int open_all(struct hub__worker *worker, struct iso_fault *fault)
{
    int error = 0;
    if (!worker->is_open) {
        error = hub_store_open(worker->options, &worker->store, fault);
        worker->is_open = !error;
    }
    if (!error && !worker->carrier) {
        hub__outlet_wipe(&worker->row);
        error = hub__outlet_load(&worker->store, &worker->id, NULL, &worker->row, fault);
        error = error ? error
                      : hub__carrier_new(&worker->row, &worker->store, worker->stop_fd,
                                         &worker->carrier, fault);
    }
    return error;
}

/* ---- after a delivery: how long to wait, in ms ---- */

static int taken(struct hub__worker *worker, const struct hub_outlet *outlet,
                 const struct hub__batch *batch)
{
    struct iso_fault fault = {.text = ""};
    worker->handed = batch->key;
    if (outlet->failures > 0) {
        fprintf(stderr, SD_NOTICE "isotherm-hub: outlet %s: it works again, after %llu failures\n",
                outlet->name, (unsigned long long)outlet->failures);
    }
    const int error = hub__batch_done(&worker->store, &worker->id, batch, &fault);
    return error ? troubled(worker, error, &fault) : AT_ONCE;
}

static int refused(struct hub__worker *worker, const struct hub_outlet *outlet,
                   const struct hub__delivery *delivery)
{
    struct iso_fault fault = {.text = ""};
    fprintf(stderr,
            SD_ERR "isotherm-hub: outlet %s has stopped: %s; `isotherm-hub outlet resume %s` lets "
                   "it go on\n",
            outlet->name, delivery->why, outlet->name);
    const int error = hub__batch_failed(&worker->store, &worker->id, outlet->failures + 1, 0, true,
                                        delivery->why, &fault);
    return error ? troubled(worker, error, &fault) : HUB__WORKER_TROUBLE_MS;
}

static int failed(struct hub__worker *worker, const struct hub_outlet *outlet,
                  const struct hub__delivery *delivery)
{
    struct iso_fault fault = {.text = ""};
    const uint64_t failures = outlet->failures + 1;
    const int64_t wait_ms = hub__backoff_ms(failures, delivery->asked_s, randombytes_random());
    if (hub__backoff_says(failures)) {
        fprintf(stderr,
                SD_WARNING "isotherm-hub: outlet %s: %s; failure %llu, the next attempt is in "
                           "%lld s\n",
                outlet->name, delivery->why, (unsigned long long)failures,
                (long long)(wait_ms + 999) / 1000);
    }
    const int error = hub__batch_failed(&worker->store, &worker->id, failures, now_ms() + wait_ms,
                                        false, delivery->why, &fault);
    return error ? troubled(worker, error, &fault) : AT_ONCE;
}

static int hand(struct hub__worker *worker, const struct hub_outlet *outlet,
                const struct hub__batch *batch)
{
    struct hub__delivery delivery = {.outcome = HUB__TAKEN};
    /* An empty batch: its events are no longer stored. */
    if (batch->n > 0 && !iso_fleet_id_is_same(&batch->key, &worker->handed)) {
        delivery = hub__carrier_hand(worker->carrier, batch);
    }
    switch (delivery.outcome) {
    case HUB__TAKEN:
        return taken(worker, outlet, batch);
    case HUB__REFUSED:
        return refused(worker, outlet, &delivery);
    case HUB__LATER:
        return failed(worker, outlet, &delivery);
    case HUB__ENDED:
        break;
    }
    return END;
}

/* How long an outlet rests before its next attempt. A time too far in the future was stored by a
 * clock that has been set back since then. */
static int rest_ms(const struct hub__outlet_row *row)
{
    const int64_t left_ms = row->next_attempt_ms - now_ms();
    if (row->outlet.stopped) {
        return HUB__WORKER_TROUBLE_MS;
    }
    if (left_ms <= 0 || left_ms > 2 * 3600 * 1000) {
        return AT_ONCE;
    }
    /* A person may let it go on earlier. */
    return left_ms < HUB__WORKER_IDLE_MS ? (int)left_ms : HUB__WORKER_IDLE_MS;
}

/* One turn; returns how long to wait until the next one, in ms, or END. */
static int turn(struct hub__worker *worker)
{
    struct iso_fault fault = {.text = ""};
    struct hub__outlet_row now = {.ca = NULL};
    struct hub__batch batch = {.n = 0};
    int error = open_all(worker, &fault);
    error = error ? error : hub__outlet_load(&worker->store, &worker->id, NULL, &now, &fault);
    if (error == -ENOENT) {
        return END;
    }
    int wait_ms = error ? AT_ONCE : rest_ms(&now);
    if (!error && wait_ms == AT_ONCE) {
        error = hub__batch_take(&worker->store, &now.outlet, &batch, &fault);
    }
    if (error) {
        wait_ms = troubled(worker, error, &fault);
    } else {
        (void)troubled(worker, 0, NULL);
    }
    if (!error && wait_ms == AT_ONCE) {
        wait_ms = iso_fleet_id_is_zero(&batch.key) ? HUB__WORKER_IDLE_MS
                                                   : hand(worker, &now.outlet, &batch);
    }
    hub__batch_clear(&batch);
    hub__outlet_wipe(&now);
    return wait_ms;
}

static void *run(void *context)
{
    struct hub__worker *worker = context;
    struct pollfd stop = {.fd = worker->stop_fd, .events = POLLIN};
    iso_thread_set_name("outlet");
    for (int wait_ms = AT_ONCE; wait_ms != END && poll(&stop, 1, wait_ms) <= 0;) {
        wait_ms = turn(worker);
    }
    hub__carrier_free(worker->carrier);
    hub__outlet_wipe(&worker->row);
    if (worker->is_open) {
        hub_store_close(&worker->store);
    }
    return NULL;
}

int hub__worker_start(const struct hub_store_options *options, const struct iso_fleet_id *outlet,
                      struct hub__worker **out, struct iso_fault *fault)
{
    struct hub__worker *worker = calloc(1, sizeof *worker);
    if (!worker) {
        return iso_fault_set(fault, -ENOMEM, "an outlet: no memory");
    }
    worker->options = options;
    worker->id = *outlet;
    worker->stop_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    const int error = worker->stop_fd < 0 ? -errno : iso_thread_start(&worker->thread, run, worker);
    if (error) {
        if (worker->stop_fd >= 0) {
            (void)close(worker->stop_fd);
        }
        free(worker);
        return iso_fault_set(fault, error, "the thread of an outlet: %s", strerror(-error));
    }
    *out = worker;
    return 0;
}

const struct iso_fleet_id *hub__worker_outlet(const struct hub__worker *worker)
{
    return &worker->id;
}

void hub__worker_ask_to_end(struct hub__worker *worker)
{
    const uint64_t one = 1;
    (void)!write(worker->stop_fd, &one, sizeof one); /* the counter cannot be full */
}

void hub__worker_free(struct hub__worker *worker)
{
    if (worker) {
        hub__worker_ask_to_end(worker);
        (void)pthread_join(worker->thread, NULL);
        (void)close(worker->stop_fd);
        free(worker);
    }
}
