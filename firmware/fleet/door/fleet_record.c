#include "firmware/fleet/door/fleet_record.h"

#include <errno.h>
#include <sodium.h>
#include <string.h>

enum { FORMAT = 1 };

/* Flags of the record, and of a zone. */
enum { LOCAL_PEOPLE = 1, HAS_POLICY = 2, RECORD_FLAGS = 4 };
enum { HAS_NEXT = 1, RESET = 2, WANTS_SNAPSHOT = 4, BEHIND = 8, LOCKDOWN = 16, ZONE_FLAGS = 32 };

/* ---- writing ---- */

static void put_term(const struct iso_fleet_term *term, struct iso_fleet_bytes *out)
{
    const bool kept = term->length_s > ISO__FLEET_TERM_KEPT_S;
    iso_fleet_put_u64(out, kept ? (uint64_t)term->length_s : 0);
    iso_fleet_put_u64(out, (uint64_t)term->begin.boot_ns);
    iso_fleet_put(out, term->begin.boot_id, sizeof term->begin.boot_id);
    iso_fleet_put_u64(out, (uint64_t)term->begin.date_s);
    iso_fleet_put_u8(out, term->begin.date_known);
}

static void put_zone(const struct iso__fleet_zone *zone, uint8_t slot, struct iso_fleet_bytes *out)
{
    iso_fleet_put_u8(out, slot);
    iso_fleet_put_u8(out, zone->rank);
    iso_fleet_put_u8(out, (uint8_t)((zone->has_next ? HAS_NEXT : 0) |
                                    (zone->has_next && zone->next.reset ? RESET : 0) |
                                    (zone->wants_snapshot ? WANTS_SNAPSHOT : 0) |
                                    (zone->behind ? BEHIND : 0) | (zone->lockdown ? LOCKDOWN : 0)));
    iso_fleet_put_place(out, &zone->place);
    iso_fleet_put(out, zone->key.bytes, sizeof zone->key.bytes);
    if (zone->has_next) {
        iso_fleet_put_place(out, &zone->next.base);
        iso_fleet_put(out, zone->next.key.bytes, sizeof zone->next.key.bytes);
    }
}

void iso__fleet_record_put(const struct iso__fleet_record *record, struct iso_fleet_bytes *out)
{
    uint8_t n = 0;
    for (int i = 0; i < ISO_FLEET_ZONES_MAX; i++) {
        n = (uint8_t)(n + record->zones[i].used);
    }
    iso_fleet_put_u8(out, FORMAT);
    iso_fleet_put_u32(out, (uint32_t)record->membership_size);
    iso_fleet_put(out, record->membership, record->membership_size);
    iso_fleet_put_u64(out, record->acked);
    iso_fleet_put_u8(out, (uint8_t)((record->local_people ? LOCAL_PEOPLE : 0) |
                                    (record->has_policy ? HAS_POLICY : 0)));
    iso_fleet_put_u32(out, record->lease_s);
    put_term(&record->term, out);
    iso_fleet_put_u8(out, n);
    for (int i = 0; i < ISO_FLEET_ZONES_MAX; i++) {
        if (record->zones[i].used) {
            put_zone(&record->zones[i], (uint8_t)i, out);
        }
    }
}

/* ---- reading ---- */

static bool take_bool(struct iso_fleet_reader *in)
{
    const uint8_t value = iso_fleet_take_u8(in);
    in->bad |= value > 1;
    return value == 1;
}

static void take_term(struct iso_fleet_reader *in, struct iso_fleet_term *term)
{
    term->length_s = (int64_t)iso_fleet_take_u64(in);
    term->begin.boot_ns = (int64_t)iso_fleet_take_u64(in);
    iso_fleet_take_bytes(in, term->begin.boot_id, sizeof term->begin.boot_id);
    term->begin.date_s = (int64_t)iso_fleet_take_u64(in);
    term->begin.date_known = take_bool(in);
    in->bad |= term->length_s < 0 || term->length_s > UINT32_MAX;
}

static void take_zone(struct iso_fleet_reader *in, struct iso__fleet_record *record)
{
    const uint8_t slot = iso_fleet_take_u8(in);
    if (slot >= ISO_FLEET_ZONES_MAX || record->zones[slot].used) {
        in->bad = true;
        return;
    }
    struct iso__fleet_zone *zone = &record->zones[slot];
    zone->used = true;
    zone->rank = iso_fleet_take_u8(in);
    const uint8_t flags = iso_fleet_take_u8(in);
    in->bad |= flags >= ZONE_FLAGS;
    zone->has_next = flags & HAS_NEXT;
    zone->wants_snapshot = flags & WANTS_SNAPSHOT;
    zone->behind = flags & BEHIND;
    zone->lockdown = flags & LOCKDOWN;
    zone->place = iso_fleet_take_place(in);
    iso_fleet_take_bytes(in, zone->key.bytes, sizeof zone->key.bytes);
    if (zone->has_next) {
        zone->next.reset = flags & RESET;
        zone->next.base = iso_fleet_take_place(in);
        iso_fleet_take_bytes(in, zone->next.key.bytes, sizeof zone->next.key.bytes);
    }
}

int iso__fleet_record_join(struct iso__fleet_record *record, const void *bytes, size_t size)
{
    const int error = size > sizeof record->membership
                          ? -EBADMSG
                          : iso_fleet_read_membership(bytes, size, &record->member);
    if (!error) {
        memcpy(record->membership, bytes, size);
        record->membership_size = size;
    }
    return error;
}

int iso__fleet_record_get(const void *bytes, size_t size, struct iso__fleet_record *out)
{
    struct iso_fleet_reader in = {.bytes = bytes, .left = size};
    struct iso__fleet_record record = {.acked = 0};
    if (iso_fleet_take_u8(&in) != FORMAT) {
        return size > 0 ? -EPROTONOSUPPORT : -EBADMSG;
    }
    const uint32_t membership_size = iso_fleet_take_u32(&in);
    const uint8_t *membership = iso_fleet_take(&in, membership_size);
    if (!membership || iso__fleet_record_join(&record, membership, membership_size)) {
        return -EBADMSG;
    }
    record.acked = iso_fleet_take_u64(&in);
    const uint8_t flags = iso_fleet_take_u8(&in);
    in.bad |= flags >= RECORD_FLAGS;
    record.local_people = flags & LOCAL_PEOPLE;
    record.has_policy = flags & HAS_POLICY;
    record.lease_s = iso_fleet_take_u32(&in);
    take_term(&in, &record.term);
    const uint8_t n = iso_fleet_take_u8(&in);
    for (int i = 0; !in.bad && i < n; i++) {
        take_zone(&in, &record);
    }
    if (iso_fleet_reader_is_done(&in)) {
        *out = record;
    }
    sodium_memzero(&record, sizeof record);
    return iso_fleet_reader_is_done(&in) ? 0 : -EBADMSG;
}

/* ---- zones ---- */

struct iso__fleet_zone *iso__fleet_zone_of(struct iso__fleet_record *record,
                                           const struct iso_fleet_id *id)
{
    for (int i = 0; i < ISO_FLEET_ZONES_MAX; i++) {
        if (record->zones[i].used && iso_fleet_id_is_same(&record->zones[i].place.zone, id)) {
            return &record->zones[i];
        }
    }
    return NULL;
}

struct iso__fleet_zone *iso__fleet_zone_free(struct iso__fleet_record *record)
{
    for (int i = 0; i < ISO_FLEET_ZONES_MAX; i++) {
        if (!record->zones[i].used) {
            return &record->zones[i];
        }
    }
    return NULL;
}

size_t iso__fleet_zones(const struct iso__fleet_record *record,
                        const struct iso__fleet_zone *zones[ISO_FLEET_ZONES_MAX])
{
    size_t n = 0;
    for (int i = 0; i < ISO_FLEET_ZONES_MAX; i++) {
        size_t at = n;
        if (!record->zones[i].used) {
            continue;
        }
        for (; at > 0 && zones[at - 1]->rank > record->zones[i].rank; at--) {
            zones[at] = zones[at - 1];
        }
        zones[at] = &record->zones[i];
        n++;
    }
    return n;
}
