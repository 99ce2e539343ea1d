/* The thread of one outlet. Internal to the outlets. */
#ifndef ISO_ENROLL_HUB_OUTLET_RUN_OUTLET_WORKER_H
#define ISO_ENROLL_HUB_OUTLET_RUN_OUTLET_WORKER_H

#include "enroll/hub/outlet/hub_outlet.h"

enum {
    HUB__WORKER_IDLE_MS = 500,     /* between two looks for new events */
    HUB__WORKER_TROUBLE_MS = 2000, /* between two attempts to reach the database */
};

struct hub__worker;

/* Starts the thread. `options` has to live longer. -ENOMEM, errors of the thread. */
int hub__worker_start(const struct hub_store_options *options, const struct iso_fleet_id *outlet,
                      struct hub__worker **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

const struct iso_fleet_id *hub__worker_outlet(const struct hub__worker *worker);

/* Asks the thread to end, which interrupts what it is handing over. */
void hub__worker_ask_to_end(struct hub__worker *worker);

/* Waits for its end, and frees it. NULL is accepted. */
void hub__worker_free(struct hub__worker *worker);

#endif
