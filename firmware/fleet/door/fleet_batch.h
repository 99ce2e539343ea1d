/* Changes of people that are stored together. Internal to the files fleet_batch.c and
 * fleet_people.c. */
#ifndef ISO_FIRMWARE_FLEET_DOOR_FLEET_BATCH_H
#define ISO_FIRMWARE_FLEET_DOOR_FLEET_BATCH_H

#include "firmware/fleet/door/fleet_state.h"

/* Bytes of a text before or after in a record of the log, as in administration/policy.c. */
enum { ISO__FLEET_TEXT_SIZE = 480 };

/* One change, with what it points to, and what it does to the index. */
struct iso__fleet_change {
    uint8_t access[ISO_CREDENTIAL_BYTES_MAX];
    uint8_t *templates; /* their bytes, one after the other */
    size_t templates_size;
    struct iso_person_name_key key; /* of the name; zeros for somebody who leaves */
    struct iso_fleet_id dropped;    /* an entry that goes; zeros: none */
    bool puts;
    struct iso__fleet_entry entry; /* the entry after it, without the number */
};

/* The record of the log that was made last and is not written yet, so that the one before a
 * transaction can wait for the disk. */
struct iso__fleet_last_note {
    bool is;
    const char *reason;
    char person[ISO_PERSON_NAME_SIZE], before[ISO__FLEET_TEXT_SIZE], after[ISO__FLEET_TEXT_SIZE];
};

struct iso__fleet_batch {
    struct iso_fleet *fleet;
    struct iso_fleet_id zone;
    uint8_t bit;
    uint64_t sequence;
    uint32_t seen; /* the number of the snapshot whose people are put; 0: none */
    struct iso__fleet_last_note note;
    size_t n;
    struct iso_gallery_change changes[ISO__FLEET_BATCH];
    struct iso__fleet_change steps[ISO__FLEET_BATCH];
};

/* Makes the next record of the log, and writes the one before. */
int iso__fleet_batch_note(struct iso__fleet_batch *batch, const char *reason, const char *person,
                          const char *before, const char *after, struct iso_fault *fault);

/* Writes the name, the limits and the credential of a person, cut to whole characters. */
void iso__fleet_describe(const struct iso_person *person,
                         const struct iso_credential_record *record,
                         char text[ISO__FLEET_TEXT_SIZE]);

/* Stores what the batch has, together with a record of the fleet. */
int iso__fleet_batch_flush(struct iso__fleet_batch *batch, const struct iso__fleet_record *draft,
                           struct iso_fault *fault);

/* Whether the batch has this person, or this name, already: then what it has is stored first. */
bool iso__fleet_batch_has(const struct iso__fleet_batch *batch, int64_t person,
                          const struct iso_person_name_key *key);

#endif
