#include "firmware/keys/key_ring_state.h"

#include <errno.h>
#include <sodium.h>
#include <string.h>

#include "core/base/bytes.h"
#include "drivers/file/data_file.h"
#include "drivers/file/directory.h"

/* The file: magic, then sealed: n u32, next number u32, number of the file u64, heads (heads.h), n
 * x (use u32, number u32, key[32]). Format 1, which can still be read, has no number and no
 * heads. */
static const char magic[8] = {'I', 'S', 'O', 'K', 'E', 'Y', 'S', '2'};

enum {
    ENTRY_BYTES = 8 + ISO_SEAL_KEY_BYTES,
    KNOWN_BYTES = 8 + ISO_HEADS_BYTES,
    PLAIN_MAX_BYTES = 8 + KNOWN_BYTES + ISO_KEY_RING_MOST * ENTRY_BYTES,
    FILE_MAX_BYTES = sizeof magic + PLAIN_MAX_BYTES + ISO_SEAL_OVERHEAD,
};

size_t iso__key_ring_file_bytes(void)
{
    return FILE_MAX_BYTES;
}

static struct iso_seal_label ring_label(char format)
{
    return iso_seal_label_of(format == '1' ? "isotherm key ring 1" : "isotherm key ring 2");
}

static size_t put_keys(const struct iso_key_list *keys, uint64_t number,
                       const struct iso_heads *known, uint8_t plain[PLAIN_MAX_BYTES])
{
    uint8_t *p = iso_put_u32(plain, keys->n);
    p = iso_put_u32(p, keys->next);
    p = iso_put_u64(p, number);
    iso_heads_put(known, p);
    p += ISO_HEADS_BYTES;
    for (uint32_t i = 0; i < keys->n; i++) {
        p = iso_put_u32(p, keys->entries[i].use);
        p = iso_put_u32(p, keys->entries[i].number);
        p = iso_put_bytes(p, keys->entries[i].key.bytes, ISO_SEAL_KEY_BYTES);
    }
    return (size_t)(p - plain);
}

static int get_keys(const uint8_t *plain, size_t size, char format, struct iso_key_list *out,
                    uint64_t *number, struct iso_heads *known)
{
    const size_t head = format == '1' ? 8 : 8 + KNOWN_BYTES;
    const uint32_t n = size >= head ? iso_get_u32(plain) : UINT32_MAX;
    if (n > ISO_KEY_RING_MOST || size != head + (size_t)n * ENTRY_BYTES) {
        return -EBADMSG;
    }
    out->n = n;
    out->next = iso_get_u32(plain + 4);
    if (format != '1') {
        *number = iso_get_u64(plain + 8);
        *known = iso_heads_get(plain + 16);
    }
    for (uint32_t i = 0; i < n; i++) {
        const uint8_t *p = plain + head + (size_t)i * ENTRY_BYTES;
        out->entries[i].use = iso_get_u32(p);
        out->entries[i].number = iso_get_u32(p + 4);
        memcpy(out->entries[i].key.bytes, p + 8, ISO_SEAL_KEY_BYTES);
    }
    return 0;
}

/* Called after writing the ring failed with `error`. If the new ring is on the disk in spite of the
 * error, it is used. Otherwise the old ring stays in use: both rings contain its keys, or the ring
 * is written again before the difference matters. */
static int settle(struct iso_key_ring *ring, const struct iso_seal_key *master, uint64_t number,
                  const void *bytes, size_t size, int error, struct iso_fault *fault)
{
    ring->unsure = true;
    if (!iso_data_file_holds(ring->path, bytes, size)) {
        return error;
    }
    iso_key_slots_take(&ring->slots, &ring->draft);
    ring->master = *master;
    ring->number = number;
    error = iso_directory_sync(ring->path, fault);
    ring->unsure = error != 0;
    return error;
}

int iso__key_ring_commit(struct iso_key_ring *ring, const struct iso_seal_key *master,
                         struct iso_fault *fault)
{
    const struct iso_seal_label label = ring_label(magic[sizeof magic - 1]);
    uint8_t plain[PLAIN_MAX_BYTES], bytes[FILE_MAX_BYTES];
    const uint64_t number = ring->number + 1;
    const struct iso_heads known = iso_heads_now(ring->board);
    const size_t size = put_keys(&ring->draft, number, &known, plain);
    memcpy(bytes, magic, sizeof magic);
    iso_seal_close(master, &label, plain, size, bytes + sizeof magic);
    sodium_memzero(plain, sizeof plain);
    const size_t length = sizeof magic + size + ISO_SEAL_OVERHEAD;
    int error = iso_data_file_replace(ring->path, bytes, length, fault);
    if (error) {
        error = settle(ring, master, number, bytes, length, error, fault);
    } else {
        iso_key_slots_take(&ring->slots, &ring->draft);
        ring->master = *master;
        ring->number = number;
        ring->unsure = false;
    }
    if (!error) {
        iso_heads_wrote(ring->board, ISO_HEAD_RING, number, NULL);
    }
    sodium_memzero(&ring->draft, sizeof ring->draft);
    return error;
}

int iso__key_ring_open_with(struct iso_key_ring *ring, const struct iso_seal_key *master,
                            const uint8_t *bytes, size_t size)
{
    uint8_t plain[PLAIN_MAX_BYTES];
    if (size < sizeof magic + ISO_SEAL_OVERHEAD || size > FILE_MAX_BYTES ||
        memcmp(bytes, magic, sizeof magic - 1) != 0) {
        return -EKEYREJECTED;
    }
    const char format = (char)bytes[sizeof magic - 1];
    const struct iso_seal_label label = ring_label(format);
    const size_t sealed = size - sizeof magic;
    struct iso_heads known = {{0}, {0}};
    int error = iso_seal_open(master, &label, bytes + sizeof magic, sealed, plain);
    if (!error) {
        error = get_keys(plain, sealed - ISO_SEAL_OVERHEAD, format, &ring->draft, &ring->number,
                         &known);
    }
    sodium_memzero(plain, sizeof plain);
    if (!error) {
        iso_key_slots_take(&ring->slots, &ring->draft);
        iso_heads_found(ring->board, ISO_HEAD_RING, ring->path, ring->number);
        iso_heads_claim(ring->board, ring->path, &known);
    }
    return error ? -EKEYREJECTED : 0;
}
