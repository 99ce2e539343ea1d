#include "firmware/transfer/transfer.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "firmware/contract/contract.h"
#include "firmware/transfer/transfer_format.h"

/* ---- key pairs ---- */

static const struct iso_seal_key *newest_key(const struct iso_key_ring *ring, enum iso_key_use use)
{
    return iso_key_ring_find(ring, use, iso_key_ring_newest(ring, use));
}

static struct iso__transfer_pair signing_pair(const struct iso_key_ring *ring)
{
    struct iso__transfer_pair pair;
    (void)crypto_sign_seed_keypair(pair.public, pair.secret, newest_key(ring, ISO_KEY_SIGN)->bytes);
    return pair;
}

struct iso__transfer_pair iso__transfer_receiving_pair(const struct iso_key_ring *ring)
{
    struct iso__transfer_pair pair;
    (void)crypto_box_seed_keypair(pair.public, pair.secret,
                                  newest_key(ring, ISO_KEY_RECEIVE)->bytes);
    return pair;
}

void iso__transfer_wipe_pair(struct iso__transfer_pair *pair)
{
    sodium_memzero(pair, sizeof *pair);
}

void iso_transfer_address(const struct iso_key_ring *ring, char address[ISO_TRANSFER_ADDRESS_SIZE])
{
    struct iso__transfer_pair sign = signing_pair(ring),
                              receive = iso__transfer_receiving_pair(ring);
    uint8_t both[2 * ISO__TRANSFER_PUBLIC_BYTES];
    (void)iso_put_bytes(iso_put_bytes(both, sign.public, ISO__TRANSFER_PUBLIC_BYTES),
                        receive.public, ISO__TRANSFER_PUBLIC_BYTES);
    (void)sodium_bin2hex(address, ISO_TRANSFER_ADDRESS_SIZE, both, sizeof both);
    iso__transfer_wipe_pair(&sign);
    iso__transfer_wipe_pair(&receive);
}

int iso__transfer_parse_address(const char *address, uint8_t halves[2][ISO__TRANSFER_PUBLIC_BYTES],
                                struct iso_fault *fault)
{
    size_t size = 0;
    uint8_t both[2 * ISO__TRANSFER_PUBLIC_BYTES];
    const char *end = NULL;
    if (strlen(address) != 2 * sizeof both ||
        sodium_hex2bin(both, sizeof both, address, 2 * sizeof both, NULL, &size, &end) || *end ||
        size != sizeof both) {
        return iso_fault_set(fault, -EINVAL, "'%.20s' is not the address of an appliance", address);
    }
    memcpy(halves, both, sizeof both);
    return 0;
}

void iso_transfer_get_keys(const struct iso_key_ring *ring, struct iso_transfer_keys *out)
{
    struct iso__transfer_pair sign = signing_pair(ring),
                              receive = iso__transfer_receiving_pair(ring);
    memcpy(out->signs, sign.public, sizeof out->signs);
    memcpy(out->sign_secret, sign.secret, sizeof out->sign_secret);
    memcpy(out->receives, receive.public, sizeof out->receives);
    memcpy(out->receive_secret, receive.secret, sizeof out->receive_secret);
    iso__transfer_wipe_pair(&sign);
    iso__transfer_wipe_pair(&receive);
}

/* ---- writing ---- */

/* A buffer that grows; its old memory is wiped. It contains n of n_people people. */
struct buffer {
    uint8_t *bytes;
    size_t size, capacity, n, n_people;
    const struct iso_work_listener *listener;
};

static int reserve_bytes(struct buffer *buffer, size_t more)
{
    if (more <= buffer->capacity - buffer->size) {
        return 0;
    }
    const size_t capacity = 2 * (buffer->size + more);
    if (capacity > 2 * (size_t)ISO_TRANSFER_MAX_BYTES) {
        return -EFBIG;
    }
    uint8_t *grown = malloc(capacity);
    if (!grown) {
        return -ENOMEM;
    }
    if (buffer->bytes) {
        memcpy(grown, buffer->bytes, buffer->size);
        iso_transfer_free(buffer->bytes, buffer->capacity);
    }
    buffer->bytes = grown;
    buffer->capacity = capacity;
    return 0;
}

static int put_item(void *context, const struct iso_gallery_item *item, struct iso_fault *fault)
{
    struct buffer *buffer = context;
    const size_t name = strlen(item->person.name);
    size_t size = 2 + name + 3 * 8 + 4;
    for (size_t i = 0; i < item->n; i++) {
        size += 8 + item->templates[i].size;
    }
    const int error = reserve_bytes(buffer, size);
    if (error) {
        return iso_fault_set(fault, error, "export: %s", strerror(-error));
    }
    uint8_t *p = iso_put_u16(buffer->bytes + buffer->size, (uint16_t)name);
    p = iso_put_bytes(p, item->person.name, name);
    p = iso_put_u64(p, (uint64_t)item->person.enrolled_s);
    p = iso_put_u64(p, (uint64_t)item->person.valid_from_s);
    p = iso_put_u64(p, (uint64_t)item->person.valid_until_s);
    p = iso_put_u32(p, (uint32_t)item->n);
    for (size_t i = 0; i < item->n; i++) {
        p = iso_put_u32(p, item->templates[i].algorithm);
        p = iso_put_u32(p, (uint32_t)item->templates[i].size);
        p = iso_put_bytes(p, item->templates[i].bytes, item->templates[i].size);
    }
    buffer->size += size;
    buffer->n++;
    iso_work_step(buffer->listener, buffer->n, buffer->n_people);
    return 0;
}

/* Counts the people who will be written. */
static size_t count_people(const struct iso_gallery *gallery, const char *const *people)
{
    size_t n = 0;
    if (!people || !*people) {
        (void)iso_gallery_people(gallery, &n);
    }
    while (people && people[n]) {
        n++;
    }
    return n;
}

static int gather_people(struct iso_gallery *gallery, const char *const *people, struct buffer *out,
                         struct iso_fault *fault)
{
    int error = reserve_bytes(out, 4);
    if (error) {
        return iso_fault_set(fault, error, "export: %s", strerror(-error));
    }
    out->size = 4;
    out->n_people = count_people(gallery, people);
    if (!people || !*people) {
        error = iso_gallery_export(gallery, NULL, put_item, out, fault);
    }
    for (; !error && people && *people; people++) {
        error = iso_gallery_export(gallery, *people, put_item, out, fault);
    }
    (void)iso_put_u32(out->bytes, (uint32_t)out->n);
    return error;
}

struct iso_seal_label iso__transfer_body_label(const uint8_t header[ISO__TRANSFER_HEADER_BYTES])
{
    struct iso_seal_label label = iso_seal_label_of("isotherm people 1");
    uint8_t digest[ISO_SEAL_DIGEST_BYTES];
    (void)crypto_generichash(digest, sizeof digest, header, ISO__TRANSFER_HEADER_BYTES, NULL, 0);
    iso_seal_label_bytes(&label, digest, sizeof digest);
    return label;
}

/* Fills in the header, and makes a random key for the file or takes the given one. */
static int lock_header(const struct iso_key_ring *ring, const struct iso_transfer_lock *lock,
                       uint8_t header[ISO__TRANSFER_HEADER_BYTES], struct iso_seal_key *key,
                       struct iso_fault *fault)
{
    struct iso__transfer_pair sign = signing_pair(ring);
    memset(header, 0, ISO__TRANSFER_HEADER_BYTES);
    (void)iso_put_bytes(header, ISO_CONTRACT_PEOPLE_MAGIC, 8);
    memcpy(header + ISO__TRANSFER_SIGNER_AT, sign.public, ISO__TRANSFER_PUBLIC_BYTES);
    iso__transfer_wipe_pair(&sign);
    if (!lock->address) {
        header[ISO_CONTRACT_PEOPLE_LOCK_AT] = ISO_CONTRACT_PEOPLE_PASSPHRASE;
        memcpy(header + ISO_CONTRACT_PEOPLE_SALT_AT, lock->salt, sizeof lock->salt);
        *key = lock->key;
        return 0;
    }
    uint8_t halves[2][ISO__TRANSFER_PUBLIC_BYTES];
    const int error = iso__transfer_parse_address(lock->address, halves, fault);
    if (error) {
        return error;
    }
    header[ISO_CONTRACT_PEOPLE_LOCK_AT] = ISO_CONTRACT_PEOPLE_APPLIANCE;
    *key = iso_seal_key_random();
    return crypto_box_seal(header + ISO__TRANSFER_KEY_AT, key->bytes, sizeof key->bytes, halves[1])
               ? iso_fault_set(fault, -EINVAL, "the address is not that of an appliance")
               : 0;
}

static int seal_file(const struct buffer *people, const struct iso_key_ring *ring,
                     const struct iso_transfer_lock *lock, uint8_t **bytes, size_t *size,
                     struct iso_fault *fault)
{
    const size_t signed_size = ISO__TRANSFER_HEADER_BYTES + people->size + ISO_SEAL_OVERHEAD;
    struct iso_seal_key key;
    if (signed_size + crypto_sign_BYTES > ISO_TRANSFER_MAX_BYTES) {
        return iso_fault_set(fault, -EFBIG, "export: more than %d bytes", ISO_TRANSFER_MAX_BYTES);
    }
    uint8_t *file = malloc(signed_size + crypto_sign_BYTES);
    if (!file) {
        return iso_fault_set(fault, -ENOMEM, "export: out of memory");
    }
    const int error = lock_header(ring, lock, file, &key, fault);
    if (error) {
        free(file);
        return error;
    }
    const struct iso_seal_label label = iso__transfer_body_label(file);
    struct iso__transfer_pair sign = signing_pair(ring);
    iso_seal_close(&key, &label, people->bytes, people->size, file + ISO__TRANSFER_HEADER_BYTES);
    (void)crypto_sign_detached(file + signed_size, NULL, file, signed_size, sign.secret);
    iso__transfer_wipe_pair(&sign);
    iso_seal_key_wipe(&key);
    *bytes = file;
    *size = signed_size + crypto_sign_BYTES;
    return 0;
}

int iso_transfer_write(struct iso_gallery *gallery, const char *const *people,
                       const struct iso_key_ring *ring, const struct iso_transfer_lock *lock,
                       const struct iso_work_listener *listener, uint8_t **bytes, size_t *size,
                       size_t *n, struct iso_fault *fault)
{
    struct buffer buffer = {.listener = listener};
    int error = gather_people(gallery, people, &buffer, fault);
    if (!error) {
        error = seal_file(&buffer, ring, lock, bytes, size, fault);
    }
    if (!error) {
        *n = buffer.n;
    }
    iso_transfer_free(buffer.bytes, buffer.capacity);
    return error;
}

void iso_transfer_free(uint8_t *bytes, size_t size)
{
    if (bytes) {
        sodium_memzero(bytes, size);
        free(bytes);
    }
}
