/* Local time in an IANA zone, computed from the zone's own file and nothing else: the C library's
 * localtime depends on the environment of the process, and on files that may change under it. Pure.
 *
 *   bytes of /usr/share/zoneinfo/NAME --iso_zone_read--> struct iso_zone
 *
 *        first_offset_s    offset_s[0]     offset_s[1]            rule
 *     ------------------|---------------|---------------|------------------->  UTC
 *                    at_s[0]         at_s[1]         at_s[n-1]
 *
 * The table holds for the past and for what is decided already, the rule for all later years. */
#ifndef ISO_FIRMWARE_POLICY_ZONE_H
#define ISO_FIRMWARE_POLICY_ZONE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "firmware/policy/zone_rule.h"
#include "isotherm/fault.h"

/* The longest table of tzdata 2025b has 310 changes (Asia/Hebron), the longest name 30 letters. */
enum { ISO_ZONE_CHANGES_MAX = 512, ISO_ZONE_NAME_SIZE = 48 };

/* RFC 8536, 3.2: offsets should be between -25 and 26 hours. */
enum { ISO_ZONE_OFFSET_MIN_S = -89999, ISO_ZONE_OFFSET_MAX_S = 93599 };

/* Offsets are seconds to add to UTC; times are seconds since 1970 UTC. */
struct iso_zone {
    char name[ISO_ZONE_NAME_SIZE];
    uint16_t n;
    int32_t first_offset_s;             /* before the first change */
    int64_t at_s[ISO_ZONE_CHANGES_MAX]; /* strictly ascending */
    int32_t offset_s[ISO_ZONE_CHANGES_MAX];
    struct iso_zone_rule rule; /* from the last change on */
};

/* Reads the bytes of a file in the format TZif (RFC 8536), versions 2 to 4. Returns 0, or a
 * negative errno with a line that names the zone; *zone is then as before.
 *
 *   -EINVAL       the name is empty or too long
 *   -EBADMSG      the file is not TZif, is cut off, or contradicts itself
 *   -EOPNOTSUPP   version 1, which has no rule for later years; a file without a rule; a zone that
 *                 counts leap seconds ("right/..."), while time in this project does not
 *   -E2BIG        the zone has more changes than ISO_ZONE_CHANGES_MAX */
int iso_zone_read(const char *name, const uint8_t *bytes, size_t size, struct iso_zone *zone,
                  struct iso_fault *fault);

/* Whether a zone that was stored is still one that iso_zone_read() can have read: nothing in it
 * leads out of its arrays or beyond a day and two hours. */
bool iso_zone_is_sound(const struct iso_zone *zone);

/* The offset at a time. */
int32_t iso_zone_offset_s(const struct iso_zone *zone, int64_t time_s);

#endif
