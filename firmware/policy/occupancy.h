/* Who is in which area. Pure. */
#ifndef ISO_FIRMWARE_POLICY_OCCUPANCY_H
#define ISO_FIRMWARE_POLICY_OCCUPANCY_H

#include "firmware/policy/policy.h"

/* Somebody was let in at an access point and has entered: the presence becomes the area that the
 * access point leads to; one that leads to none makes it unknown. Call it when the door was used,
 * not when it was unlocked. */
void iso_presence_enter(struct iso_presence *presence, const struct iso_access_point *access_point,
                        int64_t time_s);

/* An administrator resets a violation of antipassback (ONVIF's ResetAntipassbackViolation): nothing
 * is known about the person until the next entry. */
void iso_presence_forget(struct iso_presence *presence);

#endif
