#include "firmware/keys/seal.h"

#include <assert.h>
#include <errno.h>
#include <sodium.h>
#include <string.h>

#include "core/base/bytes.h"

enum {
    NONCE_BYTES = crypto_aead_xchacha20poly1305_ietf_NPUBBYTES,
    TAG_BYTES = crypto_aead_xchacha20poly1305_ietf_ABYTES,
};

_Static_assert(NONCE_BYTES + TAG_BYTES == ISO_SEAL_OVERHEAD,
               "a sealed record is longer by nonce and tag");
_Static_assert(ISO_SEAL_KEY_BYTES == crypto_aead_xchacha20poly1305_ietf_KEYBYTES &&
                   ISO_SEAL_KEY_BYTES == crypto_kdf_KEYBYTES &&
                   ISO_SEAL_DIGEST_BYTES == crypto_generichash_BYTES,
               "keys and digests have these sizes");

int iso_seal_start(struct iso_fault *fault)
{
    return sodium_init() < 0 ? iso_fault_set(fault, -EIO, "libsodium does not start") : 0;
}

void iso_seal_label_bytes(struct iso_seal_label *label, const void *bytes, size_t size)
{
    assert(size <= sizeof label->bytes - label->size);
    memcpy(label->bytes + label->size, bytes, size);
    label->size += size;
}

struct iso_seal_label iso_seal_label_of(const char *kind)
{
    struct iso_seal_label label = {.size = 0};
    iso_seal_label_bytes(&label, kind, strlen(kind) + 1);
    return label;
}

void iso_seal_label_number(struct iso_seal_label *label, uint64_t number)
{
    uint8_t bytes[8];
    (void)iso_put_u64(bytes, number);
    iso_seal_label_bytes(label, bytes, sizeof bytes);
}

struct iso_seal_key iso_seal_key_random(void)
{
    struct iso_seal_key key;
    randombytes_buf(key.bytes, sizeof key.bytes);
    return key;
}

struct iso_seal_key iso_seal_key_derive(const struct iso_seal_key *from, uint64_t number,
                                        const char context[8])
{
    struct iso_seal_key key;
    (void)crypto_kdf_derive_from_key(key.bytes, sizeof key.bytes, number, context, from->bytes);
    return key;
}

void iso_seal_key_wipe(struct iso_seal_key *key)
{
    sodium_memzero(key, sizeof *key);
}

void iso_seal_close(const struct iso_seal_key *key, const struct iso_seal_label *label,
                    const void *plain, size_t size, uint8_t *sealed)
{
    randombytes_buf(sealed, NONCE_BYTES);
    (void)crypto_aead_xchacha20poly1305_ietf_encrypt(sealed + NONCE_BYTES, NULL, plain, size,
                                                     label->bytes, label->size, NULL, sealed,
                                                     key->bytes);
}

int iso_seal_open(const struct iso_seal_key *key, const struct iso_seal_label *label,
                  const uint8_t *sealed, size_t size, void *plain)
{
    if (size < ISO_SEAL_OVERHEAD) {
        return -EBADMSG;
    }
    return crypto_aead_xchacha20poly1305_ietf_decrypt(plain, NULL, NULL, sealed + NONCE_BYTES,
                                                      size - NONCE_BYTES, label->bytes, label->size,
                                                      sealed, key->bytes)
               ? -EBADMSG
               : 0;
}

void iso_seal_digest(const struct iso_seal_key *key, const struct iso_seal_label *label,
                     const void *bytes, size_t size, uint8_t digest[ISO_SEAL_DIGEST_BYTES])
{
    crypto_generichash_state state;
    uint8_t length[8];
    (void)iso_put_u64(length, label->size);
    (void)crypto_generichash_init(&state, key->bytes, sizeof key->bytes, ISO_SEAL_DIGEST_BYTES);
    (void)crypto_generichash_update(&state, length, sizeof length);
    (void)crypto_generichash_update(&state, label->bytes, label->size);
    (void)crypto_generichash_update(&state, bytes, size);
    (void)crypto_generichash_final(&state, digest, ISO_SEAL_DIGEST_BYTES);
    sodium_memzero(&state, sizeof state);
}
