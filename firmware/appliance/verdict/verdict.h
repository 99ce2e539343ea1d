/* The steps after a verdict, in the order of verdict_finish.c: the policy is asked, the grant is
 * written to the log (verdict_record.c), the door is switched, an access controller gets the card
 * number (verdict_card.c), and the visit is recorded and reported. Internal to this folder; the
 * other files of the appliance call the functions of appliance_calls.h. */
#ifndef ISO_FIRMWARE_APPLIANCE_VERDICT_VERDICT_H
#define ISO_FIRMWARE_APPLIANCE_VERDICT_VERDICT_H

#include <stdbool.h>

#include "firmware/appliance/appliance_access.h"
#include "firmware/appliance/appliance_calls.h"

/* "allow" or "deny". */
const char *iso__verdict_word(const struct iso_verdict *verdict);

/* The note of a record: what the images showed, the companion, why there is no lease, a soft
 * violation of antipassback. */
struct iso__verdict_note {
    char text[ISO_IMAGE_TALLY_TEXT_SIZE + ISO_PERSON_NAME_SIZE + 48 + ISO__APPLIANCE_WHY_SIZE];
};

/* Makes the record of a verdict. `event` is "grant" or "visit"; `person` is a name, or "". The
 * record may point to all four, so they have to outlive it. */
struct iso_audit_record iso__verdict_record(const struct iso_appliance *appliance,
                                            const char *event, const char *person,
                                            const struct iso_verdict *verdict,
                                            struct iso__verdict_note *note);

/* Whether an access controller waits for card numbers. */
bool iso__verdict_has_controller(const struct iso_appliance *appliance);

/* Sends the card number of the admitted person, over Wiegand, over OSDP, or both, unless the door
 * stands open. The controller has locks of its own, so a failure does not change what the lock of
 * this door does. A door without a lock of its own did not unlock then: visit->door and its fault
 * say so. */
void iso__verdict_send_card(struct iso_appliance *appliance, struct iso_visit *visit);

#endif
