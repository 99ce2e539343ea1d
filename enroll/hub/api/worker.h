/* Work with the database away from the event loop. There are two lanes, each with one thread and
 * one connection: changes, which keep their order, and looks, so that a long list never lets a
 * lockdown wait. A lane does one task after another.
 *
 * All functions are called by the thread of the event loop. */
#ifndef HUB_API_WORKER_H
#define HUB_API_WORKER_H

#include <stdbool.h>
#include <systemd/sd-event.h>

#include "enroll/hub/store/hub_store.h"

enum hub_lane { HUB_LANE_CHANGES, HUB_LANE_LOOKS, HUB_LANES };

enum { HUB_WORKER_WAITING_MOST = 256 }; /* tasks of a lane that wait */

struct hub_task {
    /* Asked by the event loop right before the work; false: the task is over, and nothing more is
     * called. NULL: yes. */
    bool (*may)(void *context);
    /* In the thread. The store is that of the lane; `work` sets its actor. */
    void (*work)(void *context, struct hub_store *store);
    /* By the event loop, after the work, or instead of it: then `is_done` is false, because the
     * hub ends. */
    void (*done)(void *context, bool is_done);
    void *context;
};

struct hub_worker;

/* Starts the threads. `options` has to live longer. Errors of hub_store_open(), of the threads and
 * of the event loop. */
int hub_worker_new(sd_event *event, const struct hub_store_options *options,
                   struct hub_worker **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Waits for the work that goes on, and gives up the tasks that wait. NULL is accepted. */
void hub_worker_free(struct hub_worker *worker);

/* Lets a task wait for its turn. -EBUSY too many wait, -ENOMEM. */
int hub_worker_do(struct hub_worker *worker, enum hub_lane lane, const struct hub_task *task)
    __attribute__((warn_unused_result));

/* How many tasks of a lane wait. */
int hub_worker_waiting(const struct hub_worker *worker, enum hub_lane lane);

#endif
