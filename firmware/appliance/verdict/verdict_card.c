/* Sends the card number of the admitted person to an access controller. */
#include <errno.h>
#include <string.h>

#include "firmware/appliance/verdict/verdict.h"

/* The card of the admitted person: the first Wiegand card of the credential, else that of the file
 * of cards, whatever spelling of the name the file has. If an old gallery has two people under two
 * spellings of one name, the spelling in the file decides whose card it is. */
static bool card_of(const struct iso_appliance *appliance, const struct iso_visit *visit,
                    struct iso_wiegand_card *out)
{
    const struct iso_gallery *gallery = appliance->borrowed.gallery;
    if (visit->verdict.person == 0) {
        return false; /* the door is open to everybody */
    }
    struct iso_credential_record record = iso_site_access_credential(gallery,
                                                                     visit->verdict.person);
    bool found = false;
    for (int i = 0; i < record.n_cards && !found; i++) {
        found = record.cards[i].bits == 0;
        *out = (struct iso_wiegand_card){(unsigned)(record.cards[i].code >> 32),
                                         (unsigned)(record.cards[i].code & UINT16_MAX)};
    }
    iso_credential_record_wipe(&record);
    if (found || !appliance->borrowed.cards) {
        return found;
    }
    const struct iso_card *card = iso_cards_find(appliance->borrowed.cards, visit->person);
    const struct iso_person *owner = card ? iso_gallery_find(gallery, card->person) : NULL;
    if (!owner || strcmp(owner->name, visit->person) != 0) {
        return false;
    }
    *out = card->number;
    return true;
}

bool iso__verdict_has_controller(const struct iso_appliance *appliance)
{
    return appliance->borrowed.cards || appliance->borrowed.panel ||
           *iso_config_option(&appliance->borrowed.config->door.options, "wiegand_d0");
}

/* Sends the number to the access controller, over Wiegand, over OSDP, or both. Returns the first
 * error. */
static int send_number(struct iso_appliance *appliance, const struct iso_wiegand_card *number,
                       struct iso_fault *fault)
{
    const struct iso_config_options *lines = &appliance->borrowed.config->door.options;
    struct iso_panel *panel = appliance->borrowed.panel;
    int error = 0;
    if (!panel || *iso_config_option(lines, "wiegand_d0")) {
        error = iso_door_guard_send_card(appliance->door, number, fault);
    }
    const int other = panel ? iso_panel_send_card(panel, number, error ? NULL : fault) : 0;
    return error ? error : other;
}

void iso__verdict_send_card(struct iso_appliance *appliance, struct iso_visit *visit)
{
    struct iso_fault *fault = &appliance->outcome.card_fault;
    struct iso_wiegand_card number;
    const bool has_card = card_of(appliance, visit, &number);
    int error = -ENOENT;
    if (iso_door_guard_look(appliance->door).state != ISO_DOOR_UNLOCKED) {
        return; /* not at a fault; and a door that stands open gets no number */
    }
    if (has_card) {
        error = send_number(appliance, &number, fault);
    } else {
        (void)iso_fault_set(fault, error, "the admitted person has no card number");
    }
    if (!error) {
        return;
    }
    if (has_card) {
        (void)iso__appliance_say_fault(appliance, error, fault);
    } else {
        iso__appliance_warn(appliance, fault);
    }
    if (!iso_config_has_relay(appliance->borrowed.config)) {
        visit->door = ISO_DOOR_DID_NOT_UNLOCK;
        visit->door_fault = fault->text;
    }
}
