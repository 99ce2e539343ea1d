/* Reads a file of people. */
#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "firmware/contract/contract.h"
#include "firmware/transfer/transfer_format.h"

struct iso_transfer {
    uint8_t *plain; /* the items point into this memory */
    size_t size, n;
    struct iso_gallery_item *items;
};

/* The bytes that are still to be read. */
struct cursor {
    const uint8_t *at;
    size_t left;
};

static const uint8_t *take_bytes(struct cursor *cursor, size_t size)
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
        const uint8_t *p = take_bytes(cursor, 8);
        if (!p) {
            return -EBADMSG;
        }
        item->templates[i].algorithm = iso_get_u32(p);
        item->templates[i].size = iso_get_u32(p + 4);
        item->templates[i].bytes = take_bytes(cursor, item->templates[i].size);
        if (!item->templates[i].bytes) {
            return -EBADMSG;
        }
    }
    return 0;
}

static int get_item(struct cursor *cursor, struct iso_gallery_item *item)
{
    const uint8_t *p = take_bytes(cursor, 2);
    const size_t length = p ? iso_get_u16(p) : 0;
    const uint8_t *name = p ? take_bytes(cursor, length) : NULL;
    p = name ? take_bytes(cursor, 3 * 8 + 4) : NULL;
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
    const uint8_t *count = take_bytes(&cursor, 4);
    const size_t n = count ? iso_get_u32(count) : SIZE_MAX;
    if (n > cursor.left / (2 + 3 * 8 + 4)) {
        /* So few bytes cannot hold so many people. */
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

/* Takes ownership of `plain`, which was allocated by malloc(). */
static int parse_people(uint8_t *plain, size_t size, struct iso_transfer **out)
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
    return parse_people(copy, size, out);
}

static int check_signature(const uint8_t *bytes, size_t size, const char *sender,
                           struct iso_fault *fault)
{
    const size_t signed_size = size - crypto_sign_BYTES;
    uint8_t halves[2][ISO__TRANSFER_PUBLIC_BYTES];
    if (crypto_sign_verify_detached(bytes + signed_size, bytes, signed_size,
                                    bytes + ISO__TRANSFER_SIGNER_AT)) {
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
    const int error = iso__transfer_parse_address(sender, halves, fault);
    if (error) {
        return error;
    }
    return memcmp(halves[0], bytes + ISO__TRANSFER_SIGNER_AT, ISO__TRANSFER_PUBLIC_BYTES) != 0
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
        return iso_fault_set(fault, -EBADMSG, "import: the file does not say who can open it");
    }
    struct iso__transfer_pair receive = iso__transfer_receiving_pair(ring);
    const int wrong = crypto_box_seal_open(key->bytes, bytes + ISO__TRANSFER_KEY_AT,
                                           ISO__TRANSFER_KEY_BYTES, receive.public, receive.secret);
    iso__transfer_wipe_pair(&receive);
    return wrong ? iso_fault_set(fault, -EKEYREJECTED, "import: the file is for another appliance")
                 : 0;
}

static int open_body(const uint8_t *bytes, size_t size, const struct iso_seal_key *key,
                     struct iso_transfer **out, struct iso_fault *fault)
{
    const size_t sealed = size - ISO__TRANSFER_HEADER_BYTES - crypto_sign_BYTES;
    const struct iso_seal_label label = iso__transfer_body_label(bytes);
    uint8_t *plain = malloc(sealed);
    if (!plain) {
        return iso_fault_set(fault, -ENOMEM, "import: out of memory");
    }
    if (iso_seal_open(key, &label, bytes + ISO__TRANSFER_HEADER_BYTES, sealed, plain)) {
        iso_transfer_free(plain, sealed);
        return iso_fault_set(fault, -EKEYREJECTED, "import: the passphrase is wrong");
    }
    const int error = parse_people(plain, sealed - ISO_SEAL_OVERHEAD, out);
    if (error == -ENOMEM) {
        return iso_fault_set(fault, error, "import: out of memory");
    }
    return error ? iso_fault_set(fault, error, "import: the people cannot be read") : 0;
}

int iso_transfer_read(const uint8_t *bytes, size_t size, const struct iso_key_ring *ring,
                      const struct iso_seal_key *key, const char *sender, struct iso_transfer **out,
                      struct iso_fault *fault)
{
    struct iso_seal_key file_key;
    if (size < ISO__TRANSFER_LEAST_BYTES || size > ISO_TRANSFER_MAX_BYTES ||
        memcmp(bytes, ISO_CONTRACT_PEOPLE_MAGIC, 8) != 0) {
        return iso_fault_set(fault, -EBADMSG, "import: the file holds no exported people");
    }
    int error = check_signature(bytes, size, sender, fault);
    if (!error) {
        error = find_key(bytes, ring, key, &file_key, fault);
    }
    if (!error) {
        error = open_body(bytes, size, &file_key, out, fault);
    }
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
