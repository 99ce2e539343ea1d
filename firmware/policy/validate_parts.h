/* The parts of iso_policy_validate(). */
#ifndef ISO_FIRMWARE_POLICY_VALIDATE_PARTS_H
#define ISO_FIRMWARE_POLICY_VALIDATE_PARTS_H

#include "firmware/policy/policy.h"

/* The record that is examined, for the line of a fault: `kind "token"`. */
struct iso__record {
    const char *kind, *token;
    struct iso_fault *fault;
};

/* Whether the token has 1 to 64 bytes and its zero byte. Returns 0 or -EINVAL with a line that
 * names the record by its kind and number. */
int iso__validate_token(const char *kind, uint32_t number, const char token[ISO_TOKEN_SIZE],
                        struct iso_fault *fault);

/* Whether `index` is one of n. `what` names the thing that it refers to. */
int iso__validate_index(const struct iso__record *record, const char *what, uint32_t index,
                        uint32_t n);

/* Whether a record holds at most `max` of something. */
int iso__validate_count(const struct iso__record *record, const char *what, unsigned n,
                        unsigned max);

/* Zones, groups and schedules. */
int iso__validate_times(const struct iso_policy *policy, struct iso_fault *fault);

/* Credentials. */
int iso__validate_credentials(const struct iso_policy *policy, struct iso_fault *fault);

#endif
