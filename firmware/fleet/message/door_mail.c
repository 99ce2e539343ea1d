#include "firmware/fleet/message/door_mail.h"

#include <errno.h>

/* Signs a message that was made, and hands it over. */
static int finish(struct iso_fleet_bytes *made, const struct iso_fleet_signer *signer,
                  struct iso_fleet_bytes *out)
{
    const int error = iso_fleet_sign(made, signer);
    if (!error) {
        *out = *made;
    }
    return error;
}

int iso_fleet_make_events(const struct iso_fleet_events *events, const char *lines, size_t size,
                          const uint8_t hub[ISO_FLEET_PUBLIC_BYTES],
                          const struct iso_fleet_signer *signer, struct iso_fleet_bytes *out)
{
    struct iso_fleet_bytes made = {.bytes = NULL};
    iso_fleet_begin(&made, ISO_FLEET_EVENTS);
    iso_fleet_put(&made, events->door.bytes, sizeof events->door.bytes);
    iso_fleet_put_u64(&made, events->first);
    iso_fleet_put_u64(&made, events->last);
    iso_fleet_put_sealed(&made, hub, lines, size);
    return finish(&made, signer, out);
}

int iso_fleet_read_events(const void *bytes, size_t size,
                          const uint8_t signer[ISO_FLEET_PUBLIC_BYTES],
                          const struct iso_fleet_receiver *hub, struct iso_fleet_events *out,
                          struct iso_fleet_bytes *lines)
{
    struct iso_fleet_reader in;
    struct iso_fleet_events events;
    struct iso_fleet_bytes plain = {.bytes = NULL};
    int error = iso_fleet_verify(bytes, size, ISO_FLEET_EVENTS, signer, &in);
    if (error) {
        return error;
    }
    iso_fleet_take_bytes(&in, events.door.bytes, sizeof events.door.bytes);
    events.first = iso_fleet_take_u64(&in);
    events.last = iso_fleet_take_u64(&in);
    error = iso_fleet_take_sealed(&in, hub, &plain);
    if (!error &&
        (!iso_fleet_reader_is_done(&in) || events.first == 0 || events.last < events.first)) {
        iso_fleet_bytes_free(&plain);
        error = -EBADMSG;
    }
    if (!error) {
        *out = events;
        *lines = plain;
    }
    return error;
}

int iso_fleet_make_ack(const struct iso_fleet_ack *ack, const struct iso_fleet_signer *signer,
                       struct iso_fleet_bytes *out)
{
    struct iso_fleet_bytes made = {.bytes = NULL};
    iso_fleet_begin(&made, ISO_FLEET_ACK);
    iso_fleet_put(&made, ack->door.bytes, sizeof ack->door.bytes);
    iso_fleet_put_u64(&made, ack->number);
    return finish(&made, signer, out);
}

int iso_fleet_read_ack(const void *bytes, size_t size, const uint8_t signer[ISO_FLEET_PUBLIC_BYTES],
                       struct iso_fleet_ack *out)
{
    struct iso_fleet_reader in;
    struct iso_fleet_ack ack;
    const int error = iso_fleet_verify(bytes, size, ISO_FLEET_ACK, signer, &in);
    if (error) {
        return error;
    }
    iso_fleet_take_bytes(&in, ack.door.bytes, sizeof ack.door.bytes);
    ack.number = iso_fleet_take_u64(&in);
    if (!iso_fleet_reader_is_done(&in)) {
        return -EBADMSG;
    }
    *out = ack;
    return 0;
}

int iso_fleet_make_request(const struct iso_fleet_id *door, const struct iso_fleet_person *person,
                           const uint8_t hub[ISO_FLEET_PUBLIC_BYTES],
                           const struct iso_fleet_signer *signer, struct iso_fleet_bytes *out)
{
    struct iso_fleet_bytes body = {.bytes = NULL}, made = {.bytes = NULL};
    iso_fleet_put_person(&body, person);
    iso_fleet_begin(&made, ISO_FLEET_REQUEST);
    iso_fleet_put(&made, door->bytes, sizeof door->bytes);
    iso_fleet_put(&made, person->id.bytes, sizeof person->id.bytes);
    iso_fleet_put_sealed(&made, hub, body.bytes, body.size);
    made.error = made.error ? made.error : body.error;
    iso_fleet_bytes_free(&body);
    return finish(&made, signer, out);
}

int iso_fleet_read_request(const void *bytes, size_t size,
                           const uint8_t signer[ISO_FLEET_PUBLIC_BYTES],
                           const struct iso_fleet_receiver *hub, struct iso_fleet_id *door,
                           struct iso_fleet_bytes *body, struct iso_fleet_person *person)
{
    struct iso_fleet_reader in;
    struct iso_fleet_id sender, id;
    struct iso_fleet_bytes plain = {.bytes = NULL};
    struct iso_fleet_person read = {.n = 0};
    int error = iso_fleet_verify(bytes, size, ISO_FLEET_REQUEST, signer, &in);
    if (error) {
        return error;
    }
    iso_fleet_take_bytes(&in, sender.bytes, sizeof sender.bytes);
    iso_fleet_take_bytes(&in, id.bytes, sizeof id.bytes);
    error = iso_fleet_take_sealed(&in, hub, &plain);
    if (error) {
        return error;
    }
    if (!iso_fleet_reader_is_done(&in) || iso_fleet_read_person(plain.bytes, plain.size, &read) ||
        !iso_fleet_id_is_same(&read.id, &id)) {
        iso_fleet_bytes_free(&plain);
        return -EBADMSG;
    }
    *door = sender;
    *body = plain;
    *person = read;
    return 0;
}

int iso_fleet_make_fetch(const struct iso_fleet_fetch *fetch, const struct iso_fleet_signer *signer,
                         struct iso_fleet_bytes *out)
{
    struct iso_fleet_bytes made = {.bytes = NULL};
    iso_fleet_begin(&made, ISO_FLEET_FETCH);
    iso_fleet_put(&made, fetch->door.bytes, sizeof fetch->door.bytes);
    iso_fleet_put(&made, fetch->nonce, sizeof fetch->nonce);
    iso_fleet_put_u64(&made, (uint64_t)fetch->time_s);
    iso_fleet_put(&made, fetch->zone.bytes, sizeof fetch->zone.bytes);
    iso_fleet_put_u64(&made, fetch->after);
    iso_fleet_put_u8(&made, (uint8_t)fetch->what);
    return finish(&made, signer, out);
}

int iso_fleet_read_fetch(const void *bytes, size_t size,
                         const uint8_t signer[ISO_FLEET_PUBLIC_BYTES], struct iso_fleet_fetch *out)
{
    struct iso_fleet_reader in;
    struct iso_fleet_fetch fetch;
    const int error = iso_fleet_verify(bytes, size, ISO_FLEET_FETCH, signer, &in);
    if (error) {
        return error;
    }
    iso_fleet_take_bytes(&in, fetch.door.bytes, sizeof fetch.door.bytes);
    iso_fleet_take_bytes(&in, fetch.nonce, sizeof fetch.nonce);
    fetch.time_s = (int64_t)iso_fleet_take_u64(&in);
    iso_fleet_take_bytes(&in, fetch.zone.bytes, sizeof fetch.zone.bytes);
    fetch.after = iso_fleet_take_u64(&in);
    fetch.what = (enum iso_fleet_wanted)iso_fleet_take_u8(&in);
    if (!iso_fleet_reader_is_done(&in) ||
        (fetch.what != ISO_FLEET_WANT_DELTAS && fetch.what != ISO_FLEET_WANT_SNAPSHOT &&
         fetch.what != ISO_FLEET_WANT_UPDATE)) {
        return -EBADMSG;
    }
    *out = fetch;
    return 0;
}
