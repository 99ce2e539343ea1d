/* Whether somebody is let in. Pure: a function of the policy, the occupancy and the request. The
 * steps and their order are in the picture of policy.h; a device sends one reason, and this order
 * chooses it.
 *
 * Open: a level that is open lets everybody in, known or not, and nothing else is examined.
 *
 * What was shown: a second identifier that belongs to somebody else refuses, and so does a wrong
 * PIN, even where the level does not ask for it. If not enough was shown, the answer says what more
 * is wanted: the smallest rest of a recognition group that this person has identifiers for. If
 * there is no such group, the person cannot pass this level and is refused.
 *
 * Duress: the duress PIN counts as the PIN, and the flag `duress` is set whatever the outcome is,
 * so that nobody can see at the door that it was entered.
 *
 * Antipassback: a violation is known if the access point leads from an area and the person is in
 * another one, or if it leads from none and the person is in the area that it leads to. Of somebody
 * whose whereabouts are not known, nothing is a violation. With timed antipassback the violation is
 * another: to enter the area that the person is in, less than antipassback_s after entering it; a
 * clock that was set back makes this longer, never shorter. A soft violation lets in and sets the
 * flag `passback`; a hard or timed one refuses.
 *
 * Two people: where the security level demands two (pt:DualCredential), or the person needs an
 * escort, somebody else must be shown too, and must pass every step for the same access point. A
 * pair is refused if both need an escort, or, where two are demanded, if both have the same
 * two_person_class other than 0. */
#ifndef ISO_FIRMWARE_POLICY_DECIDE_H
#define ISO_FIRMWARE_POLICY_DECIDE_H

#include "firmware/policy/policy.h"

/* What one person has shown so far. */
struct iso_shown {
    uint8_t matched;  /* enum iso_recognition, face and card: identifiers of this credential */
    uint8_t differed; /* the same: shown, and not of this credential */
    iso_pin pin;      /* the PIN that was entered; 0: none yet */
};

struct iso_access_request {
    uint16_t access_point;
    uint32_t credential; /* or ISO_CREDENTIAL_NONE: the person is unknown */
    struct iso_shown shown;
    uint32_t companion; /* a second person; ISO_CREDENTIAL_NONE: nobody. The same person again is
                         * nobody */
    struct iso_shown companion_shown;
    int64_t time_s; /* since 1970 UTC */
};

enum iso_access_outcome {
    ISO_ACCESS_DENY = 0,
    ISO_ACCESS_ALLOW,
    ISO_ACCESS_WANT, /* not let in until more is shown */
};

/* The reasons of a refusal. */
enum iso_access_reason {
    ISO_ACCESS_OTHER = 0, /* the access point is out of service, or not of this policy */
    ISO_ACCESS_NOT_FOUND, /* the credential is not known */
    ISO_ACCESS_NOT_ENABLED,
    ISO_ACCESS_NOT_ACTIVE, /* not valid yet */
    ISO_ACCESS_EXPIRED,
    ISO_ACCESS_UNAUTHORIZED,     /* no access policy for this access point, or the person has no
                                  * identifiers with which to pass its level */
    ISO_ACCESS_NOT_AT_THIS_TIME, /* access policies, none of them now; or the level is closed */
    ISO_ACCESS_INVALID_IDENTIFIER,
    ISO_ACCESS_INVALID_PIN,
    ISO_ACCESS_ANTIPASSBACK,
    ISO_ACCESS_NO_PAIR, /* these two may not enter together */
    /* Reasons outside of the policy (firmware/access/site_access.h). */
    ISO_ACCESS_NO_LEASE,     /* a person of a fleet, whose hub has not answered for too long */
    ISO_ACCESS_NOT_APPROVED, /* enrolled at this door, and the hub admits no such people */
    ISO_ACCESS_REASONS
};

/* ONVIF's word for a reason: "Other", "CredentialNotFound" (in ONVIF the topic of an event without
 * a reason), "CredentialNotEnabled", "CredentialNotActive", "CredentialExpired", "Unauthorized",
 * "NotPermittedAtThisTime", "pt:InvalidIdentifierValue", "InvalidPIN". ONVIF has no word for the
 * others and asks for a prefix of the vendor's: "isotherm:AntipassbackViolation",
 * "isotherm:NoPair", "isotherm:NoLease", "isotherm:NotApproved". NULL outside. */
const char *iso_access_reason_name(enum iso_access_reason reason);

/* All-zero is DENY. */
struct iso_access {
    enum iso_access_outcome outcome;
    enum iso_access_reason reason;     /* of DENY */
    uint8_t wanted;                    /* of WANT: enum iso_recognition */
    bool companion_wanted;             /* of WANT: a second person */
    bool of_companion;                 /* `reason` and `wanted` are about the second person */
    bool duress;                       /* one of the two entered the duress PIN */
    bool passback, companion_passback; /* ALLOW in spite of soft antipassback */
    bool has_level;                    /* the field below counts */
    uint16_t level;                    /* the security level that held; for the event */
};

/* Decides. The policy has passed iso_policy_validate(). Indices of the request may be anything. */
struct iso_access iso_access_decide(const struct iso_policy *policy,
                                    const struct iso_occupancy *occupancy,
                                    const struct iso_access_request *request);

/* The security level that holds at an access point at a time: of the authentication policies whose
 * schedule's state asks for a level, the one with the highest priority; the default level if there
 * is none. */
struct iso_level_constraint iso_access_level_at(const struct iso_policy *policy,
                                                const struct iso_access_point *access_point,
                                                int64_t time_s);

/* Whether somebody with these identifiers can pass the level when asked for them. */
bool iso_security_level_can_pass(const struct iso_security_level *level, uint8_t identifiers);

#endif
