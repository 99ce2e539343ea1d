/* The outlets at work: one thread for each outlet, with a connection of its own to the database, so
 * that a receiver that is slow or away delays neither the others nor the event loop. Only the
 * leader of the hub's processes runs them. Two processes that do for a moment, because one has not
 * noticed yet that it does not lead any more, hand the same batch over twice, with the same key. */
#ifndef ISO_ENROLL_HUB_OUTLET_RUN_HUB_OUTLETS_H
#define ISO_ENROLL_HUB_OUTLET_RUN_HUB_OUTLETS_H

#include <systemd/sd-event.h>

#include "enroll/hub/store/hub_store.h"

struct hub_outlets;

/* Starts the outlets, and follows the table from then on: every two seconds outlets that are new
 * are started, and those that were removed end. `store` belongs to the thread of the event loop and
 * is used by it alone; `options` opens those of the threads. Both have to live longer. Errors of
 * the event loop; a database that is away is waited for. */
int hub_outlets_new(sd_event *event, struct hub_store *store,
                    const struct hub_store_options *options, struct hub_outlets **out,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

/* Ends the threads: what is being handed over is given up at once, and is handed over again by the
 * next leader. NULL is accepted. */
void hub_outlets_free(struct hub_outlets *outlets);

#endif
