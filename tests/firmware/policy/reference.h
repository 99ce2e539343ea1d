/* A second, slow implementation of decisions, written from the words of the ONVIF specifications
 * and of policy.h, for comparison. It scans lists, knows no order of records, and leaves calendar
 * and time zones to the C library. */
#ifndef TESTS_FIRMWARE_POLICY_REFERENCE_H
#define TESTS_FIRMWARE_POLICY_REFERENCE_H

#include "firmware/policy/decide.h"

/* Zone 0 of the policy is the zone of the environment variable TZ; every other zone has only the
 * fixed offset of its rule. */
struct iso_access reference_decide(const struct iso_policy *policy,
                                   const struct iso_occupancy *occupancy,
                                   const struct iso_access_request *request);

/* Whether `wanted` is right for somebody who has to show more: with it some recognition group is
 * complete that the person has identifiers for, and with nothing smaller one is. */
bool reference_wanted_is_right(const struct iso_policy *policy, uint16_t level, uint32_t credential,
                               const struct iso_shown *shown, uint8_t wanted);

#endif
