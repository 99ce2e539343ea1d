#include "firmware/fleet/message/lease.h"

#include <errno.h>
#include <string.h>

enum { FLAG_LOCAL_PEOPLE = 1 };

int iso_fleet_make_question(const struct iso_fleet_question *question,
                            const struct iso_fleet_signer *signer, struct iso_fleet_bytes *out)
{
    struct iso_fleet_bytes made = {.bytes = NULL};
    iso_fleet_begin(&made, ISO_FLEET_QUESTION);
    iso_fleet_put(&made, question->door.bytes, sizeof question->door.bytes);
    iso_fleet_put(&made, question->nonce, sizeof question->nonce);
    iso_fleet_put_u64(&made, (uint64_t)question->time_s);
    iso_fleet_put_u32(&made, question->algorithm);
    iso_fleet_put_u64(&made, question->last_event);
    iso_fleet_put_places(&made, question->places, question->n);
    iso_fleet_put_u32(&made, (uint32_t)question->health_length);
    iso_fleet_put(&made, question->health, question->health_length);
    const int error = iso_fleet_sign(&made, signer);
    if (!error) {
        *out = made;
    }
    return error;
}

int iso_fleet_read_question(const void *bytes, size_t size,
                            const uint8_t signer[ISO_FLEET_PUBLIC_BYTES],
                            struct iso_fleet_question *out)
{
    struct iso_fleet_reader in;
    struct iso_fleet_question question = {.n = 0};
    const int error = iso_fleet_verify(bytes, size, ISO_FLEET_QUESTION, signer, &in);
    if (error) {
        return error;
    }
    iso_fleet_take_bytes(&in, question.door.bytes, sizeof question.door.bytes);
    iso_fleet_take_bytes(&in, question.nonce, sizeof question.nonce);
    question.time_s = (int64_t)iso_fleet_take_u64(&in);
    question.algorithm = iso_fleet_take_u32(&in);
    question.last_event = iso_fleet_take_u64(&in);
    question.n = iso_fleet_take_places(&in, question.places);
    question.health = iso_fleet_take_text(&in, ISO_FLEET_HEALTH_MAX, &question.health_length);
    if (!iso_fleet_reader_is_done(&in)) {
        return -EBADMSG;
    }
    *out = question;
    return 0;
}

int iso_fleet_make_lease(const struct iso_fleet_lease *lease, const struct iso_fleet_signer *signer,
                         struct iso_fleet_bytes *out)
{
    struct iso_fleet_bytes made = {.bytes = NULL};
    iso_fleet_begin(&made, ISO_FLEET_LEASE);
    iso_fleet_put(&made, lease->door.bytes, sizeof lease->door.bytes);
    iso_fleet_put(&made, lease->nonce, sizeof lease->nonce);
    iso_fleet_put_u64(&made, (uint64_t)lease->time_s);
    iso_fleet_put_u32(&made, lease->lease_s);
    iso_fleet_put_u8(&made, lease->local_people ? FLAG_LOCAL_PEOPLE : 0);
    iso_fleet_put_u64(&made, lease->acked);
    iso_fleet_put_places(&made, lease->places, lease->n);
    const int error = iso_fleet_sign(&made, signer);
    if (!error) {
        *out = made;
    }
    return error;
}

int iso_fleet_read_lease(const void *bytes, size_t size,
                         const uint8_t signer[ISO_FLEET_PUBLIC_BYTES], struct iso_fleet_lease *out)
{
    struct iso_fleet_reader in;
    struct iso_fleet_lease lease = {.n = 0};
    const int error = iso_fleet_verify(bytes, size, ISO_FLEET_LEASE, signer, &in);
    if (error) {
        return error;
    }
    iso_fleet_take_bytes(&in, lease.door.bytes, sizeof lease.door.bytes);
    iso_fleet_take_bytes(&in, lease.nonce, sizeof lease.nonce);
    lease.time_s = (int64_t)iso_fleet_take_u64(&in);
    lease.lease_s = iso_fleet_take_u32(&in);
    const uint8_t flags = iso_fleet_take_u8(&in);
    lease.local_people = (flags & FLAG_LOCAL_PEOPLE) != 0;
    lease.acked = iso_fleet_take_u64(&in);
    lease.n = iso_fleet_take_places(&in, lease.places);
    if (!iso_fleet_reader_is_done(&in) || (flags & ~FLAG_LOCAL_PEOPLE) != 0) {
        return -EBADMSG;
    }
    *out = lease;
    return 0;
}

int iso_fleet_door_of(const void *bytes, size_t size, struct iso_fleet_id *door)
{
    const uint8_t *p = bytes;
    if (size < ISO_FLEET_HEADER_BYTES + ISO_FLEET_ID_BYTES + ISO_FLEET_SIGNATURE_BYTES) {
        return -EBADMSG;
    }
    memcpy(door->bytes, p + ISO_FLEET_HEADER_BYTES, sizeof door->bytes);
    return 0;
}
