/* What the tests of webhooks share: an outlet "siem" with a receiver, and a look at what has
 * arrived. Failures fail the running cmocka test. */
#ifndef TESTS_ENROLL_HUB_OUTLET_WEBHOOK_RIG_H
#define TESTS_ENROLL_HUB_OUTLET_WEBHOOK_RIG_H

#include "tests/enroll/hub/outlet/outlet_rig.h"
#include "tests/enroll/hub/outlet/receiver.h"

#define WEBHOOK_RIG_SECRET "0123456789abcdef0123"
#define WEBHOOK_RIG_LOG    "/tmp/isotherm-test-outlet.log" /* of the process of the outlets */

extern struct receiver webhook_rig_receiver;

/* For each test: a new receiver, and what store_rig_setup() makes. */
int webhook_rig_setup(void **state);
int webhook_rig_teardown(void **state);

/* Adds the outlet; `ca` are the certificates that it trusts. */
void webhook_rig_add(struct store_rig *rig, const char *events, bool from_beginning,
                     const char *ca);

enum { WEBHOOK_RIG_DOORS = 16 };

struct arrivals {
    size_t n_doors;
    char doors[WEBHOOK_RIG_DOORS][ISO_FLEET_ID_TEXT_SIZE];
    uint64_t last[WEBHOOK_RIG_DOORS]; /* the highest number of each door */
    size_t events, repeated_batches;
};

/* Reads the batches that were taken as a receiver does: what has a known key was there before. The
 * events of each door have to come without a gap, a repetition or a change of their order. */
struct arrivals webhook_rig_arrivals(void);

#endif
