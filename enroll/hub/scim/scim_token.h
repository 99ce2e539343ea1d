/* Whose token a request has. Internal to enroll/hub/scim. */
#ifndef ENROLL_HUB_SCIM_SCIM_TOKEN_H
#define ENROLL_HUB_SCIM_SCIM_TOKEN_H

#include "enroll/hub/scim/hub_scim.h"

/* Sets store->actor to "scim:NAME", and the time of use once a minute. -EACCES the token is
 * unknown.
 */
int hub__scim_token_use(struct hub_store *store, const uint8_t digest[HUB_SCIM_DIGEST_BYTES],
                        struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
