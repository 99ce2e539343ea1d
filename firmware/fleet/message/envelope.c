#include "firmware/fleet/message/envelope.h"

#include <errno.h>
#include <sodium.h>
#include <string.h>

static const uint8_t magic[4] = {'I', 'S', 'O', 'F'};

_Static_assert(ISO_FLEET_SIGNATURE_BYTES == crypto_sign_BYTES &&
                   ISO_FLEET_PUBLIC_BYTES == crypto_sign_PUBLICKEYBYTES &&
                   ISO_FLEET_SECRET_BYTES == crypto_sign_SECRETKEYBYTES &&
                   ISO_FLEET_KEY_BYTES == crypto_aead_xchacha20poly1305_ietf_KEYBYTES,
               "as libsodium has them");

int iso_fleet_start(struct iso_fault *fault)
{
    if (sodium_init() >= 0) {
        return 0;
    }
    if (fault) { /* without iso_fault_set(), so that this library needs no other of the project */
        *fault = (struct iso_fault){.text = "libsodium does not start"};
    }
    return -EIO;
}

void iso_fleet_begin(struct iso_fleet_bytes *out, enum iso_fleet_kind kind)
{
    iso_fleet_put(out, magic, sizeof magic);
    iso_fleet_put_u8(out, ISO_FLEET_VERSION);
    iso_fleet_put_u8(out, (uint8_t)kind);
    iso_fleet_put_u8(out, 0);
    iso_fleet_put_u8(out, 0);
}

int iso_fleet_sign(struct iso_fleet_bytes *out, const struct iso_fleet_signer *signer)
{
    const size_t size = out->size;
    uint8_t *signature = iso_fleet_bytes_room(out, ISO_FLEET_SIGNATURE_BYTES);
    if (!signature) {
        const int error = out->error;
        iso_fleet_bytes_free(out);
        return error;
    }
    (void)crypto_sign_detached(signature, NULL, out->bytes, size, signer->secret);
    return 0;
}

int iso_fleet_kind_of(const void *bytes, size_t size, enum iso_fleet_kind *kind)
{
    const uint8_t *p = bytes;
    if (size < ISO_FLEET_HEADER_BYTES + ISO_FLEET_SIGNATURE_BYTES ||
        memcmp(p, magic, sizeof magic) != 0) {
        return -EBADMSG;
    }
    if (p[4] > ISO_FLEET_VERSION) {
        return -EPROTONOSUPPORT;
    }
    if (p[4] != ISO_FLEET_VERSION || p[6] || p[7]) {
        return -EBADMSG;
    }
    *kind = (enum iso_fleet_kind)p[5];
    return 0;
}

static bool is_signed(const void *bytes, size_t size, const uint8_t signer[ISO_FLEET_PUBLIC_BYTES])
{
    const uint8_t *p = bytes;
    const size_t signed_size = size - ISO_FLEET_SIGNATURE_BYTES;
    return crypto_sign_verify_detached(p + signed_size, p, signed_size, signer) == 0;
}

bool iso_fleet_is_newer(const void *bytes, size_t size,
                        const uint8_t signer[ISO_FLEET_PUBLIC_BYTES])
{
    enum iso_fleet_kind kind;
    return iso_fleet_kind_of(bytes, size, &kind) == -EPROTONOSUPPORT &&
           is_signed(bytes, size, signer);
}

int iso_fleet_verify(const void *bytes, size_t size, enum iso_fleet_kind kind,
                     const uint8_t signer[ISO_FLEET_PUBLIC_BYTES], struct iso_fleet_reader *fields)
{
    const uint8_t *p = bytes;
    enum iso_fleet_kind found = kind;
    const int error = iso_fleet_kind_of(bytes, size, &found);
    if (error == -EBADMSG || (!error && found != kind)) {
        return -EBADMSG;
    }
    if (!is_signed(bytes, size, signer)) {
        return -EKEYREJECTED;
    }
    if (error) {
        return error;
    }
    *fields = (struct iso_fleet_reader){.bytes = p + ISO_FLEET_HEADER_BYTES,
                                        .left = size - ISO_FLEET_SIGNATURE_BYTES -
                                                ISO_FLEET_HEADER_BYTES};
    return 0;
}

void iso_fleet_digest(const void *bytes, size_t size, uint8_t digest[ISO_FLEET_DIGEST_BYTES])
{
    (void)crypto_generichash(digest, ISO_FLEET_DIGEST_BYTES, bytes, size, NULL, 0);
}

void iso_fleet_put_sealed(struct iso_fleet_bytes *out, const uint8_t to[ISO_FLEET_PUBLIC_BYTES],
                          const void *plain, size_t size)
{
    iso_fleet_put_u32(out, (uint32_t)(size + crypto_box_SEALBYTES));
    uint8_t *room = iso_fleet_bytes_room(out, size + crypto_box_SEALBYTES);
    if (room) {
        (void)crypto_box_seal(room, plain, size, to);
    }
}

int iso_fleet_take_sealed(struct iso_fleet_reader *in, const struct iso_fleet_receiver *receiver,
                          struct iso_fleet_bytes *plain)
{
    struct iso_fleet_bytes out = {.bytes = NULL};
    const uint32_t size = iso_fleet_take_u32(in);
    const uint8_t *sealed = iso_fleet_take(in, size);
    if (!sealed || size < crypto_box_SEALBYTES) {
        return -EBADMSG;
    }
    uint8_t *room = iso_fleet_bytes_room(&out, size - crypto_box_SEALBYTES);
    if (!room) {
        return -ENOMEM;
    }
    if (crypto_box_seal_open(room, sealed, size, receiver->public, receiver->secret)) {
        iso_fleet_bytes_free(&out);
        return -EKEYREJECTED;
    }
    *plain = out;
    return 0;
}
