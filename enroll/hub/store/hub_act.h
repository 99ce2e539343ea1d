/* The hub's own audit rows: they are a part of the transaction that they describe. Internal to the
 * rooms of the hub that change something. */
#ifndef ISO_ENROLL_HUB_STORE_HUB_ACT_H
#define ISO_ENROLL_HUB_STORE_HUB_ACT_H

#include <jansson.h>

#include "enroll/hub/store/hub_store.h"

/* Records an act of store->actor: `what` ("zone-add"), to which object (a name), and the values
 * before and after. Takes over both values; NULL is allowed and leaves the value out. */
int hub__act_add(struct hub_store *store, const char *what, const char *object, json_t *before,
                 json_t *after, struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
