/* Whether the records of a policy can be used: checked once, before the policy decides anything.
 * Pure. */
#ifndef ISO_FIRMWARE_POLICY_VALIDATE_H
#define ISO_FIRMWARE_POLICY_VALIDATE_H

#include "firmware/policy/policy.h"

/* Returns 0, or -EINVAL with a line that names the first record that is wrong, such as
 *
 *   schedule "office": Monday: the period 17:00 to 09:00 ends before it begins
 *   access profile "staff": names access point 7, and there are 4
 *
 * It refuses: a token that is empty or not ended; an index beyond its array; a number of entries
 * beyond the size of a record; a zone that iso_zone_read() would not have given; periods that are
 * inverted, overlap, are not ascending or pass midnight; special days that are not strictly
 * ascending; the same group twice in one schedule; two security levels of one priority; an open
 * level with groups; a recognition group that is empty or has unknown methods; antipassback without
 * an area to lead to, and timed antipassback without a time; an access point that leads from an
 * area to the same one; a credential without identifiers, with a PIN that is not one, with a duress
 * PIN that is the PIN or stands alone, or whose validity is before 1970 or ends before it begins.
 *
 * It does not compare the tokens of records with each other: whoever stores them does that. */
int iso_policy_validate(const struct iso_policy *policy, struct iso_fault *fault);

#endif
