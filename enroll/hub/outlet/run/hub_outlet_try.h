/* Whether an outlet works. The errors of hub_store.h. */
#ifndef ISO_ENROLL_HUB_OUTLET_RUN_HUB_OUTLET_TRY_H
#define ISO_ENROLL_HUB_OUTLET_RUN_HUB_OUTLET_TRY_H

#include "enroll/hub/store/hub_store.h"

/* Hands one event "test" over, with the number 0 and the hub as its door, and no cursor moves.
 * -ENOENT; -EREMOTEIO the receiver did not take it, which the fault describes. */
int hub_outlet_try(struct hub_store *store, const char *name, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
