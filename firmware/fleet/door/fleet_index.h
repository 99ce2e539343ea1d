/* Who is at the door, by the ids of the fleet. Internal to firmware/fleet/door. */
#ifndef ISO_FIRMWARE_FLEET_DOOR_FLEET_INDEX_H
#define ISO_FIRMWARE_FLEET_DOOR_FLEET_INDEX_H

#include "firmware/fleet/door/fleet_store.h"
#include "firmware/fleet/message/fleet_id.h"
#include "firmware/policy/credential/credential_record.h"

struct iso__fleet_entry {
    struct iso_fleet_id id;
    int64_t person;    /* number in the store */
    uint64_t revision; /* 0: enrolled here; the id is that of iso_fleet_request_id() */
    uint8_t zones;
    uint8_t templates[16];
    uint32_t seen; /* the snapshot that had this person last */
};

/* Entries in ascending order of id. All zero is empty. */
struct iso__fleet_index {
    struct iso__fleet_entry *entries;
    size_t n, capacity;
    size_t n_local;                     /* entries of people who were enrolled here */
    struct iso_gallery_version version; /* of the store that they describe; "": none */
};

void iso__fleet_index_done(struct iso__fleet_index *index);

/* Makes the entries anew if the store was changed since, by somebody else. *changed says whether it
 * was. -ENOMEM. */
int iso__fleet_index_refresh(struct iso__fleet_index *index, const struct iso_fleet_store *store,
                             const struct iso_fleet_id *door, bool *changed);

/* NULL: there is none. */
struct iso__fleet_entry *iso__fleet_index_find(const struct iso__fleet_index *index,
                                               const struct iso_fleet_id *id);

/* Makes room for n more entries. -ENOMEM. */
int iso__fleet_index_reserve(struct iso__fleet_index *index, size_t n);

/* Puts an entry in place of that of the same id. The caller has made room. */
void iso__fleet_index_put(struct iso__fleet_index *index, const struct iso__fleet_entry *entry);
void iso__fleet_index_drop(struct iso__fleet_index *index, const struct iso_fleet_id *id);

/* The credential of a person; one that cannot be read is disabled. */
struct iso_credential_record iso__fleet_credential(const struct iso_fleet_store *store,
                                                   int64_t person);

/* The entry that a credential makes. */
struct iso__fleet_entry iso__fleet_entry_of(const struct iso_credential_record *record,
                                            int64_t person);

#endif
