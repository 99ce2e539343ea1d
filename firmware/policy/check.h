/* Finds in a valid policy what is hardly meant. Pure.
 *
 * A finding is certain: at no time from `now_s` on is anybody let in that way. (Who is let in
 * because a level is open needs no access policy.) The opposite is not: the check does not compare
 * the hours of an access policy with those of the security levels, so there are policies without a
 * finding that let nobody in. */
#ifndef ISO_FIRMWARE_POLICY_CHECK_H
#define ISO_FIRMWARE_POLICY_CHECK_H

#include <stddef.h>

#include "firmware/policy/policy.h"

enum iso_policy_flaw {
    ISO_POLICY_SCHEDULE_NEVER, /* a schedule that is never active any more */
    ISO_POLICY_PERSON_NOWHERE, /* an enabled credential, not expired, that no access policy lets in
                                */
    ISO_POLICY_POINT_WITHOUT_WAY, /* an access point in service that lets nobody in */
    ISO_POLICY_FLAWS
};

struct iso_policy_finding {
    enum iso_policy_flaw flaw;
    uint32_t index; /* of the schedule, the credential or the access point */
};

/* Writes the first `max` findings and returns how many there are: schedules first, then
 * credentials, then access points, each in their order. */
size_t iso_policy_check(const struct iso_policy *policy, int64_t now_s,
                        struct iso_policy_finding *findings, size_t max);

enum { ISO_POLICY_FINDING_TEXT_SIZE = 160 };

/* The finding as one line that names the record. Returns the text. */
const char *iso_policy_finding_text(const struct iso_policy *policy,
                                    const struct iso_policy_finding *finding,
                                    char text[ISO_POLICY_FINDING_TEXT_SIZE]);

#endif
