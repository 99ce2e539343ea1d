/* The carrier of webhooks: one POST for each batch. Internal to the outlets. */
#ifndef ISO_ENROLL_HUB_OUTLET_CARRY_WEBHOOK_H
#define ISO_ENROLL_HUB_OUTLET_CARRY_WEBHOOK_H

#include "enroll/hub/outlet/carry/transfer.h"

/* Sends a batch, signed with the time `now_s`. An answer 2xx takes it. 408, 425, 429 and 5xx ask
 * for another attempt, at the time of their Retry-After if they have one. All other answers refuse,
 * also redirections: whoever answers for the receiver must not choose another one. */
struct hub__delivery hub__webhook_hand(struct hub__transfer *transfer,
                                       const struct hub__outlet_row *row, int64_t now_s,
                                       const struct hub__batch *batch);

#endif
