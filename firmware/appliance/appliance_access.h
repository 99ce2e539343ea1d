/* WATCH: the policy of the site at this door. Internal to firmware/appliance. */
#ifndef ISO_FIRMWARE_APPLIANCE_APPLIANCE_ACCESS_H
#define ISO_FIRMWARE_APPLIANCE_APPLIANCE_ACCESS_H

#include "firmware/appliance/appliance_state.h"

int iso__appliance_new_access(struct iso_appliance *appliance); /* -ENOMEM */
void iso__appliance_free_access(struct iso_appliance *appliance);

/* Takes the stored policy into use, and reports one that cannot be used. -ENOMEM. */
int iso__appliance_load_policy(struct iso_appliance *appliance);

/* Ends the wait for more, if there is one: the person is refused, on record. */
void iso__appliance_end_wait(struct iso_appliance *appliance);

/* Applies the policy to the verdict of a face. Returns false if the person has to show more, and so
 * there is no verdict yet. */
bool iso__appliance_ask_policy(struct iso_appliance *appliance, struct iso_verdict *verdict);

/* The person whom a face is compared with, after a card; 0: everybody. */
int64_t iso__appliance_only_person(const struct iso_appliance *appliance);

/* What the person at the door has to show: a word ISO_CONTRACT_WANTED_..., or "". */
const char *iso__appliance_wanted(const struct iso_appliance *appliance);

/* Whether the clock can be trusted to tell the date. */
bool iso__appliance_knows_date(const struct iso_appliance *appliance);

/* (appliance_reader.c) Takes the cards and keys of the reader; reports its loss and its return. */
void iso__appliance_read_cards(struct iso_appliance *appliance);

/* Shows at the card reader, if it can, whether somebody is let in. */
void iso__appliance_show_at_reader(const struct iso_appliance *appliance, bool allow);

/* "off", "works", "lost". */
const char *iso__appliance_reader_state(const struct iso_appliance *appliance);

/* Refuses somebody who did not show what was wanted in time. */
void iso__appliance_access_time(struct iso_appliance *appliance, int64_t now_ns);
int64_t iso__appliance_access_due_ns(const struct iso_appliance *appliance);

/* The people of a verdict were let in, and the door was unlocked or stood open: they count as
 * inside, although nobody saw them walk through. */
void iso__appliance_entered(struct iso_appliance *appliance, const struct iso_verdict *verdict);

#endif
