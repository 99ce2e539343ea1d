/* What a door keeps of its fleet, and its bytes in the store, which seals them. Internal to
 * firmware/fleet/door. Pure. */
#ifndef ISO_FIRMWARE_FLEET_DOOR_FLEET_RECORD_H
#define ISO_FIRMWARE_FLEET_DOOR_FLEET_RECORD_H

#include "firmware/fleet/door/fleet_term.h"
#include "firmware/fleet/message/lease.h"
#include "firmware/fleet/message/membership.h"
#include "firmware/fleet/message/zone_key.h"

enum {
    ISO__FLEET_MEMBERSHIP_MAX = 512, /* bytes of the message */
    /* A lease that is not longer than this is not stored: after a restart the hub is asked. */
    ISO__FLEET_TERM_KEPT_S = 60,
};

/* A zone of the door. Its index in the record is the bit of its grants (credential_record.h). */
struct iso__fleet_zone {
    bool used;
    uint8_t rank;                 /* in the list of the hub; 0: the home zone */
    struct iso_fleet_place place; /* epoch 0: there is no key yet */
    struct iso_fleet_zone_key key;
    bool has_next; /* the key of a later epoch, which begins at next.base */
    struct iso_fleet_key_grant next;
    bool wants_snapshot, behind, lockdown;
};

struct iso__fleet_record {
    uint8_t membership[ISO__FLEET_MEMBERSHIP_MAX];
    size_t membership_size; /* 0: the door belongs to no fleet */
    struct iso_fleet_membership member;
    uint64_t acked;
    bool local_people, has_policy; /* has_policy: the policy of the door came from the hub */
    uint32_t lease_s;              /* as the hub said it */
    struct iso_fleet_term term;
    struct iso__fleet_zone zones[ISO_FLEET_ZONES_MAX];
};

/* The bytes of a record, which the caller frees (out->error: -ENOMEM). get: -EPROTONOSUPPORT of a
 * newer version, -EBADMSG. */
void iso__fleet_record_put(const struct iso__fleet_record *record, struct iso_fleet_bytes *out);
int iso__fleet_record_get(const void *bytes, size_t size, struct iso__fleet_record *out);

/* Takes a membership into a record; errors of iso_fleet_read_membership(). */
int iso__fleet_record_join(struct iso__fleet_record *record, const void *bytes, size_t size);

/* The zone with this id, or NULL; a place for another one, or NULL. */
struct iso__fleet_zone *iso__fleet_zone_of(struct iso__fleet_record *record,
                                           const struct iso_fleet_id *id);
struct iso__fleet_zone *iso__fleet_zone_free(struct iso__fleet_record *record);

/* The bit of a zone's grants. */
static inline uint8_t iso__fleet_zone_bit(const struct iso__fleet_record *record,
                                          const struct iso__fleet_zone *zone)
{
    return (uint8_t)(1u << (zone - record->zones));
}

/* The zones in the order of the hub's list; returns their number. */
size_t iso__fleet_zones(const struct iso__fleet_record *record,
                        const struct iso__fleet_zone *zones[ISO_FLEET_ZONES_MAX]);

#endif
