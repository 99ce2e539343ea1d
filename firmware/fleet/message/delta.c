#include "firmware/fleet/message/delta.h"

#include <errno.h>
#include <sodium.h>
#include <string.h>

enum {
    NONCE_BYTES = crypto_aead_xchacha20poly1305_ietf_NPUBBYTES,
    TAG_BYTES = crypto_aead_xchacha20poly1305_ietf_ABYTES,
    OVERHEAD = NONCE_BYTES + TAG_BYTES,
    /* Header and fields before the sealed change, which are bound to it. */
    BOUND_BYTES = ISO_FLEET_HEADER_BYTES + ISO_FLEET_ID_BYTES + 8 + 8 + 8 + ISO_FLEET_DIGEST_BYTES,
};

int iso_fleet_make_delta(struct iso_fleet_delta *delta, const void *change, size_t size,
                         const struct iso_fleet_zone_key *key,
                         const struct iso_fleet_signer *signer, struct iso_fleet_bytes *out)
{
    struct iso_fleet_bytes made = {.bytes = NULL};
    if (size > ISO_FLEET_MESSAGE_MAX - BOUND_BYTES - OVERHEAD - 4 - ISO_FLEET_SIGNATURE_BYTES) {
        return -EFBIG;
    }
    iso_fleet_begin(&made, ISO_FLEET_DELTA);
    iso_fleet_put(&made, delta->place.zone.bytes, sizeof delta->place.zone.bytes);
    iso_fleet_put_u64(&made, delta->place.epoch);
    iso_fleet_put_u64(&made, delta->place.sequence);
    iso_fleet_put_u64(&made, (uint64_t)delta->time_s);
    iso_fleet_put(&made, delta->before, sizeof delta->before);
    iso_fleet_put_u32(&made, (uint32_t)(size + OVERHEAD));
    uint8_t *sealed = iso_fleet_bytes_room(&made, size + OVERHEAD);
    if (sealed) {
        randombytes_buf(sealed, NONCE_BYTES);
        (void)crypto_aead_xchacha20poly1305_ietf_encrypt(sealed + NONCE_BYTES, NULL, change, size,
                                                         made.bytes, BOUND_BYTES, NULL, sealed,
                                                         key->bytes);
    }
    const int error = iso_fleet_sign(&made, signer);
    if (error) {
        return error;
    }
    iso_fleet_digest(made.bytes, made.size, delta->place.digest);
    *out = made;
    return 0;
}

static void take_delta(struct iso_fleet_reader *in, struct iso_fleet_delta *out)
{
    iso_fleet_take_bytes(in, out->place.zone.bytes, sizeof out->place.zone.bytes);
    out->place.epoch = iso_fleet_take_u64(in);
    out->place.sequence = iso_fleet_take_u64(in);
    out->time_s = (int64_t)iso_fleet_take_u64(in);
    iso_fleet_take_bytes(in, out->before, sizeof out->before);
    const uint32_t sealed = iso_fleet_take_u32(in);
    (void)iso_fleet_take(in, sealed);
    if (sealed < OVERHEAD || out->place.epoch == 0 || out->place.sequence == 0) {
        in->bad = true;
    }
}

int iso_fleet_read_delta(const void *bytes, size_t size,
                         const uint8_t signer[ISO_FLEET_PUBLIC_BYTES], struct iso_fleet_delta *out)
{
    struct iso_fleet_reader in;
    struct iso_fleet_delta delta = {.time_s = 0};
    const int error = size > ISO_FLEET_MESSAGE_MAX
                          ? -EBADMSG
                          : iso_fleet_verify(bytes, size, ISO_FLEET_DELTA, signer, &in);
    if (error) {
        return error;
    }
    take_delta(&in, &delta);
    if (!iso_fleet_reader_is_done(&in)) {
        return -EBADMSG;
    }
    iso_fleet_digest(bytes, size, delta.place.digest);
    *out = delta;
    return 0;
}

int iso_fleet_open_delta(const void *bytes, size_t size, const struct iso_fleet_zone_key *key,
                         struct iso_fleet_bytes *change)
{
    const uint8_t *p = bytes;
    struct iso_fleet_bytes out = {.bytes = NULL};
    if (size < BOUND_BYTES + 4 + OVERHEAD + ISO_FLEET_SIGNATURE_BYTES) {
        return -EBADMSG;
    }
    const size_t sealed_size = size - BOUND_BYTES - 4 - ISO_FLEET_SIGNATURE_BYTES;
    const uint8_t *sealed = p + BOUND_BYTES + 4;
    uint8_t *room = iso_fleet_bytes_room(&out, sealed_size - OVERHEAD + 1);
    if (!room) {
        return -ENOMEM;
    }
    if (crypto_aead_xchacha20poly1305_ietf_decrypt(room, NULL, NULL, sealed + NONCE_BYTES,
                                                   sealed_size - NONCE_BYTES, p, BOUND_BYTES,
                                                   sealed, key->bytes)) {
        iso_fleet_bytes_free(&out);
        return -EKEYREJECTED;
    }
    out.size = sealed_size - OVERHEAD;
    *change = out;
    return 0;
}

enum iso_fleet_step iso_fleet_step_of(const struct iso_fleet_place *here,
                                      const struct iso_fleet_delta *delta)
{
    const struct iso_fleet_place *there = &delta->place;
    if (!iso_fleet_id_is_same(&here->zone, &there->zone)) {
        return ISO_FLEET_STEP_FOREIGN;
    }
    if (there->sequence <= here->sequence) {
        const bool is_same = memcmp(there->digest, here->digest, sizeof here->digest) == 0;
        return there->sequence == here->sequence && !is_same ? ISO_FLEET_STEP_FOREIGN
                                                             : ISO_FLEET_STEP_KNOWN;
    }
    if (there->epoch != here->epoch) {
        return there->epoch > here->epoch ? ISO_FLEET_STEP_EPOCH : ISO_FLEET_STEP_FOREIGN;
    }
    if (there->sequence != here->sequence + 1) {
        return ISO_FLEET_STEP_GAP;
    }
    return memcmp(delta->before, here->digest, sizeof here->digest) == 0 ? ISO_FLEET_STEP_NEXT
                                                                         : ISO_FLEET_STEP_FOREIGN;
}
