#include "firmware/fleet/message/place.h"

#include <string.h>

void iso_fleet_put_place(struct iso_fleet_bytes *out, const struct iso_fleet_place *place)
{
    iso_fleet_put(out, place->zone.bytes, sizeof place->zone.bytes);
    iso_fleet_put_u64(out, place->epoch);
    iso_fleet_put_u64(out, place->sequence);
    iso_fleet_put(out, place->digest, sizeof place->digest);
}

struct iso_fleet_place iso_fleet_take_place(struct iso_fleet_reader *in)
{
    struct iso_fleet_place place;
    iso_fleet_take_bytes(in, place.zone.bytes, sizeof place.zone.bytes);
    place.epoch = iso_fleet_take_u64(in);
    place.sequence = iso_fleet_take_u64(in);
    iso_fleet_take_bytes(in, place.digest, sizeof place.digest);
    return place;
}

void iso_fleet_put_places(struct iso_fleet_bytes *out, const struct iso_fleet_place *places,
                          size_t n)
{
    iso_fleet_put_u8(out, (uint8_t)n);
    for (size_t i = 0; i < n; i++) {
        iso_fleet_put_place(out, &places[i]);
    }
}

size_t iso_fleet_take_places(struct iso_fleet_reader *in,
                             struct iso_fleet_place places[ISO_FLEET_ZONES_MAX])
{
    const uint8_t n = iso_fleet_take_u8(in);
    if (n > ISO_FLEET_ZONES_MAX) {
        in->bad = true;
    }
    for (size_t i = 0; !in->bad && i < n; i++) {
        places[i] = iso_fleet_take_place(in);
    }
    return in->bad ? 0 : n;
}
