/* Renewing the certificate of the door before it ends. The key stays: the request for the new
 * certificate is signed by it, and the hub knows it from the earlier one, so that the request needs
 * no other proof. A certificate that has ended is renewed, too. */
#ifndef ISO_FIRMWARE_FLEET_PROGRAM_RENEW_H
#define ISO_FIRMWARE_FLEET_PROGRAM_RENEW_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/fleet/program/home.h"

/* Whether a certificate that was stored at `stored_s` and ends at `ends_s` has less than a third of
 * its time left. Pure. */
bool link_renew_is_due(int64_t stored_s, int64_t ends_s, int64_t now_s);

/* The same for the certificate in `folder`; and when it ends. Errors of reading it. */
int link_renew_look(const char *folder, int64_t now_s, bool *is_due, int64_t *ends_s,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

/* Asks the hub for a new certificate and stores it. Waits for the answer. Errors of hub_call.h and
 * of the disk; the old certificate then stays. */
int link_renew(const char *folder, const struct link_home *home, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
