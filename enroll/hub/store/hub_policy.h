/* Whether a text is a policy, or a credential, that the doors will accept. Internal to the hub. */
#ifndef ISO_ENROLL_HUB_STORE_HUB_POLICY_H
#define ISO_ENROLL_HUB_STORE_HUB_POLICY_H

#include "core/base/fault.h"

/* 0, also for "" (no policy); -EINVAL with the fault of the reader; -ENOMEM. */
int hub__policy_check(const char *document, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The same for a credential as JSON. */
int hub__credential_check(const char *json, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
