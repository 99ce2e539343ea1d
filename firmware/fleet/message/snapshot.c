#include "firmware/fleet/message/snapshot.h"

#include <errno.h>
#include <string.h>

#include "core/base/bytes.h"

enum {
    STREAM_HEADER_BYTES = crypto_secretstream_xchacha20poly1305_HEADERBYTES,
    STREAM_EXTRA_BYTES = crypto_secretstream_xchacha20poly1305_ABYTES,
    PLACE_BYTES = ISO_FLEET_ID_BYTES + 8 + 8 + ISO_FLEET_DIGEST_BYTES,
    CHUNKS_AT = ISO_FLEET_HEADER_BYTES + PLACE_BYTES + 8 + STREAM_HEADER_BYTES,
};

_Static_assert(ISO_FLEET_KEY_BYTES == crypto_secretstream_xchacha20poly1305_KEYBYTES,
               "the zone's key is a key of the stream");

static int write_signed(struct iso_fleet_snapshot_writer *writer, const void *bytes, size_t size)
{
    (void)crypto_sign_update(&writer->signature, bytes, size);
    return writer->write(writer->context, bytes, size);
}

int iso_fleet_snapshot_begin(struct iso_fleet_snapshot_writer *writer,
                             const struct iso_fleet_place *place, int64_t time_s,
                             const struct iso_fleet_zone_key *key)
{
    struct iso_fleet_bytes head = {.bytes = NULL};
    uint8_t header[STREAM_HEADER_BYTES];
    (void)crypto_sign_init(&writer->signature);
    (void)crypto_secretstream_xchacha20poly1305_init_push(&writer->stream, header, key->bytes);
    iso_fleet_begin(&head, ISO_FLEET_SNAPSHOT);
    iso_fleet_put_place(&head, place);
    iso_fleet_put_u64(&head, (uint64_t)time_s);
    iso_fleet_put(&head, header, sizeof header);
    const int error = head.error ? head.error : write_signed(writer, head.bytes, head.size);
    iso_fleet_bytes_free(&head);
    return error;
}

static int push(struct iso_fleet_snapshot_writer *writer, const void *plain, size_t size,
                uint8_t tag)
{
    struct iso_fleet_bytes chunk = {.bytes = NULL};
    iso_fleet_put_u32(&chunk, (uint32_t)(size + STREAM_EXTRA_BYTES));
    uint8_t *room = iso_fleet_bytes_room(&chunk, size + STREAM_EXTRA_BYTES);
    if (room) {
        (void)crypto_secretstream_xchacha20poly1305_push(&writer->stream, room, NULL, plain, size,
                                                         NULL, 0, tag);
    }
    const int error = chunk.error ? chunk.error : write_signed(writer, chunk.bytes, chunk.size);
    iso_fleet_bytes_free(&chunk);
    return error;
}

int iso_fleet_snapshot_add(struct iso_fleet_snapshot_writer *writer, const void *change,
                           size_t size)
{
    return size == 0 || size > ISO_FLEET_SNAPSHOT_CHUNK_MAX
               ? -EFBIG
               : push(writer, change, size, crypto_secretstream_xchacha20poly1305_TAG_MESSAGE);
}

int iso_fleet_snapshot_end(struct iso_fleet_snapshot_writer *writer,
                           const struct iso_fleet_signer *signer)
{
    uint8_t signature[ISO_FLEET_SIGNATURE_BYTES];
    int error = push(writer, "", 0, crypto_secretstream_xchacha20poly1305_TAG_FINAL);
    if (!error) {
        (void)crypto_sign_final_create(&writer->signature, signature, NULL, signer->secret);
        error = writer->write(writer->context, signature, sizeof signature);
    }
    sodium_memzero(writer, sizeof *writer);
    return error;
}

int iso_fleet_snapshot_verify(const uint8_t *bytes, size_t size,
                              const uint8_t signer[ISO_FLEET_PUBLIC_BYTES],
                              struct iso_fleet_place *place)
{
    crypto_sign_state state;
    enum iso_fleet_kind kind;
    const int error = iso_fleet_kind_of(bytes, size, &kind);
    if (error == -EBADMSG ||
        (!error && (kind != ISO_FLEET_SNAPSHOT || size < CHUNKS_AT + ISO_FLEET_SIGNATURE_BYTES))) {
        return -EBADMSG;
    }
    const size_t signed_size = size - ISO_FLEET_SIGNATURE_BYTES;
    (void)crypto_sign_init(&state);
    (void)crypto_sign_update(&state, bytes, signed_size);
    if (crypto_sign_final_verify(&state, bytes + signed_size, signer)) {
        return -EKEYREJECTED;
    }
    if (error) {
        return error; /* of the hub, and of a newer version */
    }
    struct iso_fleet_reader in = {.bytes = bytes + ISO_FLEET_HEADER_BYTES, .left = PLACE_BYTES};
    *place = iso_fleet_take_place(&in);
    return 0;
}

/* Opens the next chunk of the stream into `plain`, and says whether it is the last. */
static int pull(crypto_secretstream_xchacha20poly1305_state *stream, struct iso_fleet_reader *in,
                struct iso_fleet_bytes *plain, bool *last)
{
    unsigned char tag = 0;
    const uint32_t size = iso_fleet_take_u32(in);
    const uint8_t *sealed = iso_fleet_take(in, size);
    if (!sealed || size < STREAM_EXTRA_BYTES ||
        size - STREAM_EXTRA_BYTES > ISO_FLEET_SNAPSHOT_CHUNK_MAX) {
        return -EBADMSG;
    }
    uint8_t *room = iso_fleet_bytes_room(plain, size - STREAM_EXTRA_BYTES + 1);
    if (!room) {
        return -ENOMEM;
    }
    if (crypto_secretstream_xchacha20poly1305_pull(stream, room, NULL, &tag, sealed, size, NULL,
                                                   0)) {
        return -EKEYREJECTED;
    }
    plain->size = size - STREAM_EXTRA_BYTES;
    *last = tag == crypto_secretstream_xchacha20poly1305_TAG_FINAL;
    return *last && plain->size > 0 ? -EBADMSG : 0;
}

int iso_fleet_snapshot_each(const uint8_t *bytes, size_t size, const struct iso_fleet_zone_key *key,
                            int (*each)(void *context, const struct iso_fleet_change *change),
                            void *context)
{
    crypto_secretstream_xchacha20poly1305_state stream;
    if (size < CHUNKS_AT + ISO_FLEET_SIGNATURE_BYTES) {
        return -EBADMSG;
    }
    if (crypto_secretstream_xchacha20poly1305_init_pull(
            &stream, bytes + CHUNKS_AT - STREAM_HEADER_BYTES, key->bytes)) {
        return -EKEYREJECTED;
    }
    struct iso_fleet_reader in = {.bytes = bytes + CHUNKS_AT,
                                  .left = size - CHUNKS_AT - ISO_FLEET_SIGNATURE_BYTES};
    int error = 0;
    for (bool last = false; !error && !last;) {
        struct iso_fleet_bytes plain = {.bytes = NULL};
        struct iso_fleet_change change;
        error = pull(&stream, &in, &plain, &last);
        if (!error && !last) {
            error = iso_fleet_read_change(plain.bytes, plain.size, &change);
            error = error ? error : each(context, &change);
        }
        iso_fleet_bytes_free(&plain);
    }
    sodium_memzero(&stream, sizeof stream);
    return error ? error : iso_fleet_reader_is_done(&in) ? 0 : -EBADMSG;
}
