/* How events get from an outlet to its receiver: a carrier for each kind, whose calls wait.
 * Internal to the outlets. */
#ifndef ISO_ENROLL_HUB_OUTLET_CARRY_CARRIER_H
#define ISO_ENROLL_HUB_OUTLET_CARRY_CARRIER_H

#include "enroll/hub/outlet/batch.h"

enum {
    HUB__CONNECT_MS = 10000,
    HUB__ANSWER_MS = 30000, /* after the request was begun */
};

enum hub__outcome {
    HUB__TAKEN,
    HUB__LATER,   /* it failed, and may succeed later */
    HUB__REFUSED, /* it fails until a person changes something */
    HUB__ENDED,   /* it was given up because stop_fd became readable */
};

struct hub__delivery {
    enum hub__outcome outcome;
    int64_t asked_s; /* HUB__LATER: how long the receiver asks to wait; 0: it does not */
    char why[HUB_OUTLET_TROUBLE_SIZE]; /* of a failure */
};

struct hub__carrier;

/* `row` has to live longer. stop_fd: becomes readable when everything has to end; -1: never.
 * -ENOMEM, -EINVAL. */
int hub__carrier_new(const struct hub__outlet_row *row, const struct hub_store *store, int stop_fd,
                     struct hub__carrier **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* NULL is accepted. */
void hub__carrier_free(struct hub__carrier *carrier);

/* Hands a batch over. */
struct hub__delivery hub__carrier_hand(struct hub__carrier *carrier,
                                       const struct hub__batch *batch);

/* A delivery that has failed with this text. */
struct hub__delivery hub__delivery_failed(enum hub__outcome outcome, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
