#include "firmware/gallery/transfer.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "firmware/contract/contract.h"

enum {
    SEALED_KEY_AT = 32,
    SEALED_KEY_BYTES = ISO_SEAL_KEY_BYTES + crypto_box_SEALBYTES,
    SIGNER_AT = SEALED_KEY_AT + SEALED_KEY_BYTES,
    HEADER_BYTES = SIGNER_AT + crypto_sign_PUBLICKEYBYTES,
    LEAST_BYTES = HEADER_BYTES + ISO_SEAL_OVERHEAD + 4 + crypto_sign_BYTES,
    PUBLIC_BYTES = 32, /* of either half of an address */
};

_Static_assert(HEADER_BYTES == 144 && SEALED_KEY_BYTES == 80, "as the header says");

struct pair {
    uint8_t public[PUBLIC_BYTES], secret[crypto_sign_SECRETKEYBYTES];
};

/* ---- key pairs ---- */

static const struct iso_seal_key *newest(const struct iso_key_ring *ring, enum iso_key_use use)
{
    return iso_key_ring_find(ring, use, iso_key_ring_newest(ring, use));
}

static struct pair signing_pair(const struct iso_key_ring *ring)
{
    struct pair pair;
    (void)crypto_sign_seed_keypair(pair.public, pair.secret, newest(ring, ISO_KEY_SIGN)->bytes);
    return pair;
}

static struct pair receiving_pair(const struct iso_key_ring *ring)
{
    struct pair pair;
    (void)crypto_box_seed_keypair(pair.public, pair.secret, newest(ring, ISO_KEY_RECEIVE)->bytes);
    return pair;
}

static void wipe_pair(struct pair *pair)
{
    sodium_memzero(pair, sizeof *pair);
}

void iso_transfer_address(const struct iso_key_ring *ring, char address[ISO_TRANSFER_ADDRESS_SIZE])
{
    struct pair sign = signing_pair(ring), receive = receiving_pair(ring);
    uint8_t both[2 * PUBLIC_BYTES];
    (void)iso_put_bytes(iso_put_bytes(both, sign.public, PUBLIC_BYTES), receive.public,
                        PUBLIC_BYTES);
    (void)sodium_bin2hex(address, ISO_TRANSFER_ADDRESS_SIZE, both, sizeof both);
    wipe_pair(&sign);
    wipe_pair(&receive);
}

/* The halves of an address: whom it names as a signer, and to whom one seals. */
static int parse_address(const char *address, uint8_t halves[2][PUBLIC_BYTES],
                         struct iso_fault *fault)
{
    size_t size = 0;
    uint8_t both[2 * PUBLIC_BYTES];
    const char *end = NULL;
    if (strlen(address) != 2 * sizeof both ||
        sodium_hex2bin(both, sizeof both, address, 2 * sizeof both, NULL, &size, &end) || *end ||
        size != sizeof both) {
        return iso_fault_set(fault, -EINVAL, "'%.20s' is not the address of an appliance", address);
    }
    memcpy(halves, both, sizeof both);
    return 0;
}

/* ---- writing ---- */

/* A buffer that grows, and is wiped where it was; it takes n people up to now, of n_people. */
struct buffer {
    uint8_t *bytes;
    size_t size, capacity, n, n_people;
    const struct iso_work_listener *listener;
};

static int reserve(struct buffer *buffer, size_t more)
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
    const int error = reserve(buffer, size);
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

/* How many people will be written. */
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

static int gather(struct iso_gallery *gallery, const char *const *people, struct buffer *out,
                  struct iso_fault *fault)
{
    int error = reserve(out, 4);
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

static struct iso_seal_label body_label(const uint8_t header[HEADER_BYTES])
{
    struct iso_seal_label label = iso_seal_label_of("isotherm people 1");
    uint8_t digest[ISO_SEAL_DIGEST_BYTES];
    (void)crypto_generichash(digest, sizeof digest, header, HEADER_BYTES, NULL, 0);
    iso_seal_label_bytes(&label, digest, sizeof digest);
    return label;
}

/* Fills the header, and draws or takes the file's key. */
static int lock_header(const struct iso_key_ring *ring, const struct iso_transfer_lock *lock,
                       uint8_t header[HEADER_BYTES], struct iso_seal_key *key,
                       struct iso_fault *fault)
{
    struct pair sign = signing_pair(ring);
    memset(header, 0, HEADER_BYTES);
    (void)iso_put_bytes(header, ISO_CONTRACT_PEOPLE_MAGIC, 8);
    memcpy(header + SIGNER_AT, sign.public, PUBLIC_BYTES);
    wipe_pair(&sign);
    if (!lock->address) {
        header[ISO_CONTRACT_PEOPLE_LOCK_AT] = ISO_CONTRACT_PEOPLE_PASSPHRASE;
        memcpy(header + ISO_CONTRACT_PEOPLE_SALT_AT, lock->salt, sizeof lock->salt);
        *key = lock->key;
        return 0;
    }
    uint8_t halves[2][PUBLIC_BYTES];
    const int error = parse_address(lock->address, halves, fault);
    if (error) {
        return error;
    }
    header[ISO_CONTRACT_PEOPLE_LOCK_AT] = ISO_CONTRACT_PEOPLE_APPLIANCE;
    *key = iso_seal_key_random();
    return crypto_box_seal(header + SEALED_KEY_AT, key->bytes, sizeof key->bytes, halves[1])
               ? iso_fault_set(fault, -EINVAL, "the address is not that of an appliance")
               : 0;
}

static int seal_file(const struct buffer *people, const struct iso_key_ring *ring,
                     const struct iso_transfer_lock *lock, uint8_t **bytes, size_t *size,
                     struct iso_fault *fault)
{
    const size_t signed_size = HEADER_BYTES + people->size + ISO_SEAL_OVERHEAD;
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
    const struct iso_seal_label label = body_label(file);
    struct pair sign = signing_pair(ring);
    iso_seal_close(&key, &label, people->bytes, people->size, file + HEADER_BYTES);
    (void)crypto_sign_detached(file + signed_size, NULL, file, signed_size, sign.secret);
    wipe_pair(&sign);
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
    int error = gather(gallery, people, &buffer, fault);
    error = error ? error : seal_file(&buffer, ring, lock, bytes, size, fault);
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

/* ---- reading ---- */

struct iso_transfer {
    uint8_t *plain; /* the items point into it */
    size_t size, n;
    struct iso_gallery_item *items;
};

/* What is left to be read. */
struct cursor {
    const uint8_t *at;
    size_t left;
};

static const uint8_t *take(struct cursor *cursor, size_t size)
{
    const uint8_t *at = cursor->at;
    if (size > cursor->left) {
        return NULL;
    }
    cursor->at += size;
    cursor->left -= size;
    return at;
}

static int get_templates(struct cursor *cursor, struct iso_gallery_item *item)
{
    for (size_t i = 0; i < item->n; i++) {
        const uint8_t *p = take(cursor, 8);
        if (!p) {
            return -EBADMSG;
        }
        item->templates[i].algorithm = iso_get_u32(p);
        item->templates[i].size = iso_get_u32(p + 4);
        item->templates[i].bytes = take(cursor, item->templates[i].size);
        if (!item->templates[i].bytes) {
            return -EBADMSG;
        }
    }
    return 0;
}

static int get_item(struct cursor *cursor, struct iso_gallery_item *item)
{
    const uint8_t *p = take(cursor, 2);
    const size_t length = p ? iso_get_u16(p) : 0;
    const uint8_t *name = p ? take(cursor, length) : NULL;
    p = name ? take(cursor, 3 * 8 + 4) : NULL;
    if (!p || length >= sizeof item->person.name || memchr(name, '\0', length)) {
        return -EBADMSG;
    }
    memcpy(item->person.name, name, length);
    item->person.enrolled_s = (int64_t)iso_get_u64(p);
    item->person.valid_from_s = (int64_t)iso_get_u64(p + 8);
    item->person.valid_until_s = (int64_t)iso_get_u64(p + 16);
    item->n = iso_get_u32(p + 24);
    return item->n < 1 || item->n > ISO_GALLERY_TEMPLATES_MAX ? -EBADMSG
                                                              : get_templates(cursor, item);
}

static int parse_items(struct iso_transfer *transfer)
{
    struct cursor cursor = {transfer->plain, transfer->size};
    const uint8_t *count = take(&cursor, 4);
    const size_t n = count ? iso_get_u32(count) : SIZE_MAX;
    if (n > cursor.left / (2 + 3 * 8 + 4)) { /* so few bytes cannot be so many people */
        return -EBADMSG;
    }
    transfer->items = calloc(n ? n : 1, sizeof *transfer->items);
    if (!transfer->items) {
        return -ENOMEM;
    }
    for (; transfer->n < n; transfer->n++) {
        const int error = get_item(&cursor, &transfer->items[transfer->n]);
        if (error) {
            return error;
        }
    }
    return cursor.left ? -EBADMSG : 0;
}

/* Takes `plain` over, which is malloc'd. */
static int parse(uint8_t *plain, size_t size, struct iso_transfer **out)
{
    struct iso_transfer *transfer = calloc(1, sizeof *transfer);
    if (!transfer) {
        iso_transfer_free(plain, size);
        return -ENOMEM;
    }
    transfer->plain = plain;
    transfer->size = size;
    const int error = parse_items(transfer);
    if (error) {
        iso_transfer_done(transfer);
        return error;
    }
    *out = transfer;
    return 0;
}

int iso_transfer_parse(const uint8_t *plain, size_t size, struct iso_transfer **out)
{
    uint8_t *copy = malloc(size ? size : 1);
    if (!copy) {
        return -ENOMEM;
    }
    memcpy(copy, plain, size);
    return parse(copy, size, out);
}

static int check_signature(const uint8_t *bytes, size_t size, const char *sender,
                           struct iso_fault *fault)
{
    const size_t signed_size = size - crypto_sign_BYTES;
    uint8_t halves[2][PUBLIC_BYTES];
    if (crypto_sign_verify_detached(bytes + signed_size, bytes, signed_size, bytes + SIGNER_AT)) {
        return iso_fault_set(fault, -EBADMSG,
                             "import: the file is damaged: its signature is wrong");
    }
    if (!sender) {
        return bytes[ISO_CONTRACT_PEOPLE_LOCK_AT] == ISO_CONTRACT_PEOPLE_APPLIANCE
                   ? iso_fault_set(fault, -EINVAL,
                                   "import: a file for this appliance needs the sender's address: "
                                   "anybody could have sealed it")
                   : 0;
    }
    const int error = parse_address(sender, halves, fault);
    if (error) {
        return error;
    }
    return memcmp(halves[0], bytes + SIGNER_AT, PUBLIC_BYTES) != 0
               ? iso_fault_set(fault, -EKEYREJECTED,
                               "import: another appliance has signed the file")
               : 0;
}

static int find_key(const uint8_t *bytes, const struct iso_key_ring *ring,
                    const struct iso_seal_key *given, struct iso_seal_key *key,
                    struct iso_fault *fault)
{
    if (bytes[ISO_CONTRACT_PEOPLE_LOCK_AT] == ISO_CONTRACT_PEOPLE_PASSPHRASE) {
        if (!given) {
            return iso_fault_set(fault, -EINVAL, "import: the file needs a passphrase");
        }
        *key = *given;
        return 0;
    }
    if (bytes[ISO_CONTRACT_PEOPLE_LOCK_AT] != ISO_CONTRACT_PEOPLE_APPLIANCE) {
        return iso_fault_set(fault, -EBADMSG, "import: it is not known who can open this file");
    }
    struct pair receive = receiving_pair(ring);
    const int wrong = crypto_box_seal_open(key->bytes, bytes + SEALED_KEY_AT, SEALED_KEY_BYTES,
                                           receive.public, receive.secret);
    wipe_pair(&receive);
    return wrong ? iso_fault_set(fault, -EKEYREJECTED, "import: the file is for another appliance")
                 : 0;
}

static int open_body(const uint8_t *bytes, size_t size, const struct iso_seal_key *key,
                     struct iso_transfer **out, struct iso_fault *fault)
{
    const size_t sealed = size - HEADER_BYTES - crypto_sign_BYTES;
    const struct iso_seal_label label = body_label(bytes);
    uint8_t *plain = malloc(sealed);
    if (!plain) {
        return iso_fault_set(fault, -ENOMEM, "import: out of memory");
    }
    if (iso_seal_open(key, &label, bytes + HEADER_BYTES, sealed, plain)) {
        iso_transfer_free(plain, sealed);
        return iso_fault_set(fault, -EKEYREJECTED, "import: the passphrase is wrong");
    }
    const int error = parse(plain, sealed - ISO_SEAL_OVERHEAD, out);
    return error ? iso_fault_set(fault, error, "import: %s",
                                 error == -ENOMEM ? "out of memory" : "the people cannot be read")
                 : 0;
}

int iso_transfer_read(const uint8_t *bytes, size_t size, const struct iso_key_ring *ring,
                      const struct iso_seal_key *key, const char *sender, struct iso_transfer **out,
                      struct iso_fault *fault)
{
    struct iso_seal_key file_key;
    if (size < LEAST_BYTES || size > ISO_TRANSFER_MAX_BYTES ||
        memcmp(bytes, ISO_CONTRACT_PEOPLE_MAGIC, 8) != 0) {
        return iso_fault_set(fault, -EBADMSG, "import: the file holds no exported people");
    }
    int error = check_signature(bytes, size, sender, fault);
    error = error ? error : find_key(bytes, ring, key, &file_key, fault);
    error = error ? error : open_body(bytes, size, &file_key, out, fault);
    iso_seal_key_wipe(&file_key);
    return error;
}

const struct iso_gallery_item *iso_transfer_items(const struct iso_transfer *transfer, size_t *n)
{
    *n = transfer->n;
    return transfer->items;
}

void iso_transfer_done(struct iso_transfer *transfer)
{
    if (transfer) {
        iso_transfer_free(transfer->plain, transfer->size);
        free(transfer->items);
        free(transfer);
    }
}
