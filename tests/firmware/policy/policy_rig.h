/* A small policy that tests change: everything is allowed that a test does not forbid. */
#ifndef TESTS_FIRMWARE_POLICY_POLICY_RIG_H
#define TESTS_FIRMWARE_POLICY_POLICY_RIG_H

#include "firmware/policy/decide.h"

/* Indices of the records of the rig. */
enum { RIG_OUTSIDE, RIG_INSIDE, RIG_LAB, RIG_AREAS };
enum { RIG_ALWAYS, RIG_NEVER, RIG_OFFICE, RIG_SCHEDULES };
enum {
    RIG_FACE,         /* face */
    RIG_CARD_PIN,     /* card and PIN */
    RIG_FACE_OR_CARD, /* face, or card and PIN */
    RIG_CLOSED,
    RIG_OPEN,
    RIG_LEVELS
};
enum { RIG_ENTRY, RIG_EXIT, RIG_LAB_DOOR, RIG_ACCESS_POINTS };
enum { RIG_ANNA, RIG_BEN, RIG_CARL, RIG_CREDENTIALS };
enum { RIG_STAFF, RIG_ACCESS_PROFILES };

enum { RIG_PIN = 14711, RIG_DURESS_PIN = 14712 };

/* Wednesday 2026-11-25, 12:00 UTC. */
#define RIG_NOON_S INT64_C(1795608000)

/* The clock is UTC. RIG_OFFICE is Monday to Friday, 8 to 17. Every access point has the level
 * RIG_FACE. Everybody has face, card and PIN, and the profile RIG_STAFF, which lets in at every
 * access point at any time. */
struct policy_rig {
    struct iso_zone zone;
    struct iso_special_day_group group; /* "holidays": 2026-12-25 */
    struct iso_schedule schedules[RIG_SCHEDULES];
    struct iso_area areas[RIG_AREAS];
    struct iso_security_level levels[RIG_LEVELS];
    struct iso_authentication_profile authentication; /* of all access points */
    struct iso_access_point access_points[RIG_ACCESS_POINTS];
    struct iso_access_profile access_profiles[RIG_ACCESS_PROFILES];
    struct iso_credential credentials[RIG_CREDENTIALS];
    struct iso_presence presences[RIG_CREDENTIALS];
    struct iso_policy policy;
    struct iso_occupancy occupancy;
};

void policy_rig_init(struct policy_rig *rig);

/* Adds an authentication policy: the level holds while the schedule is active. */
void policy_rig_ask(struct policy_rig *rig, uint16_t schedule, uint16_t level, bool dual);

/* Anna shows her face at the entry at noon. */
struct iso_access_request policy_rig_request(void);

struct iso_access policy_rig_decide(const struct policy_rig *rig,
                                    const struct iso_access_request *request);

#endif
