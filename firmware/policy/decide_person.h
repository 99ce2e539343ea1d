/* The steps of a decision that concern one person alone. Part of decide.h. */
#ifndef ISO_FIRMWARE_POLICY_DECIDE_PERSON_H
#define ISO_FIRMWARE_POLICY_DECIDE_PERSON_H

#include "firmware/policy/decide.h"

/* One person before an access point of the policy, which is in service. */
struct iso__person_case {
    const struct iso_policy *policy;
    const struct iso_occupancy *occupancy;
    uint16_t access_point;
    const struct iso_security_level *level; /* not an open one */
    uint32_t credential;                    /* anything */
    const struct iso_shown *shown;
    int64_t time_s;
};

/* All-zero is DENY. */
struct iso__person_answer {
    enum iso_access_outcome outcome;
    enum iso_access_reason reason;
    uint8_t wanted;
    bool passback;
};

/* Decides for this person as if nobody else mattered. */
struct iso__person_answer iso__person_decide(const struct iso__person_case *person);

#endif
