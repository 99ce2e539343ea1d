/* Who may enter, where and when: the data of a policy. The terms are ONVIF's (the specifications of
 * Access Control, Access Rules, Schedule, Credential and Authentication Behavior); a comment names
 * what differs. Everything in this folder is pure: it reads no file, no clock and no environment.
 *
 *   credential ---> access profile ---> access policy = access point + schedule
 *   (a person)      (a role)            "this door, at these hours"; all of them count together
 *
 *   access point ---> authentication profile ---> security level = what to show, by schedule
 *   (a door,                                      (face; card and PIN; nothing: open; ...)
 *   one way)    '---> area it leads from, area it leads to; antipassback
 *
 *   schedule ----> hours of each weekday; hours of special days, which replace them; time zone
 *
 * How a decision flows (decide.h). The first step that fails gives the reason:
 *
 *     access point, credential, what was shown, time
 *        |
 *     the access point is in service           no:   DENY Other
 *     the security level that holds now        open: ALLOW
 *        |
 *   .- one person --------------------------------------------------------------.
 *   | the credential is known                  no:   DENY CredentialNotFound    |
 *   | it is enabled                            no:   DENY CredentialNotEnabled  |
 *   | it is valid now                          no:   DENY CredentialNotActive   |
 *   |                                                or CredentialExpired       |
 *   | an access policy names the access point  no:   DENY Unauthorized          |
 *   | its schedule is active now               no:   DENY NotPermittedAtThisTime|
 *   | the level is not closed                  no:   DENY NotPermittedAtThisTime|
 *   | what was shown is this person's          no:   DENY InvalidIdentifierValue|
 *   |                                                or InvalidPIN              |
 *   | it is enough for the level               no:   WANT more of this person,  |
 *   |                                                or DENY Unauthorized       |
 *   | no violation of antipassback             no:   DENY AntipassbackViolation,|
 *   |                                                or a remark if it is soft  |
 *   '---------------------------------------------------------------------------'
 *        |
 *     two people or an escort are needed       no:   ALLOW
 *     a second person is there                 no:   WANT one
 *     the same box for the second person
 *     these two may enter together             no:   DENY NoPair
 *                                              yes:  ALLOW
 *
 * Records are plain structs of bounded size. They refer to each other by indices into the arrays of
 * struct iso_policy, so that they can be stored, compared and wiped as they are. validate.h checks
 * them; all other functions rely on that. check.h finds what is valid and hardly meant. */
#ifndef ISO_FIRMWARE_POLICY_POLICY_H
#define ISO_FIRMWARE_POLICY_POLICY_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/policy/zone.h"

enum {
    ISO_TOKEN_SIZE = 65, /* a pt:ReferenceToken of at most 64 bytes, and a zero byte */
    ISO_INDEX_NONE = 0xffff,
    ISO_PERIODS_MAX = 8,                 /* MaxTimePeriodsPerDay */
    ISO_SPECIAL_SCHEDULES_MAX = 8,       /* MaxSpecialDaysSchedules */
    ISO_SPECIAL_DAYS_MAX = 64,           /* MaxDaysInSpecialDayGroup */
    ISO_ACCESS_POLICIES_MAX = 64,        /* MaxAccessPoliciesPerAccessProfile */
    ISO_CREDENTIAL_PROFILES_MAX = 8,     /* MaxAccessProfilesPerCredential */
    ISO_RECOGNITION_GROUPS_MAX = 4,      /* MaxRecognitionGroupsPerSecurityLevel */
    ISO_AUTHENTICATION_POLICIES_MAX = 8, /* MaxPoliciesPerAuthenticationProfile */
};

/* No credential: the person is unknown, or there is no second person. */
#define ISO_CREDENTIAL_NONE UINT32_MAX

/* Where an index is said to be "or none", it may be ISO_INDEX_NONE. */

/* ---- when */

/* A period of a day: from_min <= t < to_min, in minutes after midnight by the clock on the wall,
 * with 0 <= from_min < to_min <= 1440. ONVIF counts seconds; this project counts minutes. */
struct iso_period {
    uint16_t from_min, to_min;
};

/* The periods of one day, ascending, without overlap. No period: nobody at any time. */
struct iso_day_hours {
    uint8_t n;
    struct iso_period periods[ISO_PERIODS_MAX];
};

/* Dates on which other hours hold, such as the holidays of a year. */
struct iso_special_day_group {
    char token[ISO_TOKEN_SIZE];
    uint8_t n;
    int32_t days[ISO_SPECIAL_DAYS_MAX]; /* calendar.h; strictly ascending */
};

/* ONVIF's SpecialDaysSchedule: the hours of all days of a group. */
struct iso_special_hours {
    uint16_t group;
    struct iso_day_hours hours;
};

/* ONVIF's schedule with weekly recurrence (ExtendedRecurrenceSupported is false), compiled: no
 * iCalendar is left to interpret at the door. schedule.h says what it means. */
struct iso_schedule {
    char token[ISO_TOKEN_SIZE];
    uint16_t zone;
    struct iso_day_hours weekly[7]; /* 0 is Sunday */
    uint8_t n_special;
    struct iso_special_hours special[ISO_SPECIAL_SCHEDULES_MAX];
};

/* ---- where */

struct iso_area {
    char token[ISO_TOKEN_SIZE];
};

/* What happens when somebody enters who, as far as is known, is somewhere else. ONVIF leaves the
 * rules to the device. The violation is defined in decide.h. */
enum iso_antipassback {
    ISO_ANTIPASSBACK_NONE = 0,
    ISO_ANTIPASSBACK_SOFT,  /* let in and reported */
    ISO_ANTIPASSBACK_HARD,  /* refused */
    ISO_ANTIPASSBACK_TIMED, /* refused for antipassback_s after the same area was entered */
};

struct iso_access_point {
    char token[ISO_TOKEN_SIZE];
    bool enabled;
    uint16_t from, to; /* areas, or none */
    uint16_t authentication_profile;
    uint8_t antipassback;   /* enum iso_antipassback; needs `to` */
    int32_t antipassback_s; /* 1 or more with ISO_ANTIPASSBACK_TIMED, else 0 */
};

/* ---- what to show */

/* ONVIF's recognition methods, as bits. */
enum iso_recognition {
    ISO_RECOGNITION_FACE = 1, /* pt:Face */
    ISO_RECOGNITION_CARD = 2, /* pt:Card */
    ISO_RECOGNITION_PIN = 4,  /* pt:PIN */
    ISO_RECOGNITION_ALL = 7,
};

/* Each recognition group is a set of methods (enum iso_recognition): all methods of one group are
 * needed. In ONVIF a level without groups is open and a group without methods is closed. Here an
 * open level has the flag `open` and no groups, so that a record of zeros is closed. */
struct iso_security_level {
    char token[ISO_TOKEN_SIZE];
    bool open;
    int32_t priority; /* higher is stricter; no two levels have the same */
    uint8_t n_groups; /* 0 without `open`: closed */
    uint8_t groups[ISO_RECOGNITION_GROUPS_MAX];
};

/* The state of a schedule at one moment: ONVIF's Active and SpecialDay as two bits. */
enum iso_schedule_state {
    ISO_SCHEDULE_INACTIVE = 0,
    ISO_SCHEDULE_ACTIVE = 1,
    ISO_SCHEDULE_SPECIAL = 2, /* a special day, outside its hours */
    ISO_SCHEDULE_SPECIAL_ACTIVE = 3,
    ISO_SCHEDULE_STATES
};

/* What one state of a schedule asks for. */
struct iso_level_constraint {
    uint16_t level; /* or none: this state asks for nothing */
    bool dual;      /* pt:DualCredential: two people are needed; otherwise pt:SingleCredential */
};

struct iso_authentication_policy {
    uint16_t schedule;
    struct iso_level_constraint constraints[ISO_SCHEDULE_STATES]; /* by enum iso_schedule_state */
};

struct iso_authentication_profile {
    char token[ISO_TOKEN_SIZE];
    uint16_t default_level; /* where no policy asks for a level; one person is enough then */
    uint8_t n_policies;
    struct iso_authentication_policy policies[ISO_AUTHENTICATION_POLICIES_MAX];
};

/* ---- who */

struct iso_access_policy {
    uint16_t access_point, schedule;
};

struct iso_access_profile {
    char token[ISO_TOKEN_SIZE];
    uint8_t n_policies;
    struct iso_access_policy policies[ISO_ACCESS_POLICIES_MAX];
};

/* A PIN of 4 to 9 digits as one number: a 1 before its digits, so "0042" is 10042. 0: no PIN. It is
 * as secret as what it is stored in, because so few digits can be guessed from any hash. */
typedef uint32_t iso_pin;

enum { ISO_PIN_DIGITS_MIN = 4, ISO_PIN_DIGITS_MAX = 9 };

struct iso_credential {
    char token[ISO_TOKEN_SIZE];
    char disabled_reason[32]; /* ONVIF's Reason of its state, such as "pt:CredentialLost"; may be ""
                               */
    bool enabled;
    bool no_antipassback;     /* never a violation of antipassback */
    bool needs_escort;        /* may enter only together with somebody who does not need one */
    uint8_t two_person_class; /* two people of the same class are no pair; 0: of no class */
    uint8_t identifiers;      /* enum iso_recognition: what this person can show */
    iso_pin pin, duress_pin;  /* pin: with ISO_RECOGNITION_PIN; duress_pin: or 0. A person who is
                               * forced enters it instead of the PIN */
    int64_t valid_from_s, valid_to_s; /* UTC since 1970; 0: no limit; valid_to_s is not included */
    uint8_t n_profiles;
    uint16_t profiles[ISO_CREDENTIAL_PROFILES_MAX];
};

/* ---- all of it */

/* The policy of a site: arrays that the caller owns, and that stay as they are while it is used. */
struct iso_policy {
    const struct iso_zone *zones;
    const struct iso_special_day_group *groups;
    const struct iso_schedule *schedules;
    const struct iso_area *areas;
    const struct iso_security_level *levels;
    const struct iso_authentication_profile *authentication_profiles;
    const struct iso_access_point *access_points;
    const struct iso_access_profile *access_profiles;
    const struct iso_credential *credentials;
    uint16_t n_zones, n_groups, n_schedules, n_areas, n_levels, n_authentication_profiles,
        n_access_points, n_access_profiles;
    uint32_t n_credentials;
};

/* Where somebody is. Zeros: not known. */
struct iso_presence {
    bool known;
    uint16_t area;
    int64_t since_s; /* when the area was entered */
};

/* The occupancy of the areas: where the holder of each credential is, in the order of
 * iso_policy.credentials. */
struct iso_occupancy {
    const struct iso_presence *presences;
    uint32_t n; /* n_credentials, or 0: nothing is known about anybody */
};

#endif
