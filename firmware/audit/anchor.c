#include "firmware/audit/anchor.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/bytes.h"
#include "drivers/file/data_file.h"
#include "drivers/file/disk_wait.h"
#include "drivers/file/file.h"
#include "drivers/file/storage_fault.h"

enum {
    PLAIN_1_BYTES = 8 + 8 + ISO_ANCHOR_EXTRA_BYTES, /* format 1: turn, value, extra */
    PLAIN_BYTES = PLAIN_1_BYTES + ISO_HEADS_BYTES,
    USED_1_BYTES = 4 + PLAIN_1_BYTES + ISO_SEAL_OVERHEAD,
    USED_BYTES = 4 + PLAIN_BYTES + ISO_SEAL_OVERHEAD,
    SLOT_BYTES = 4096, /* in different sectors: a torn write damages one slot only */
};

_Static_assert(USED_BYTES <= 512, "a slot is written in one sector");

struct iso_anchor {
    int fd;
    char *path;
    const char *kind;
    const struct iso_key_ring *ring;
    bool sync;
    uint64_t turn; /* the turn of the valid slot; the next write goes to the other one */
    struct iso_anchor_state state;
    struct iso_heads known;
};

static struct iso_seal_label slot_label(const char *format, const char *kind, uint32_t key)
{
    struct iso_seal_label label = iso_seal_label_of(format);
    iso_seal_label_bytes(&label, kind, strlen(kind) + 1);
    iso_seal_label_number(&label, key);
    return label;
}

static const char format_1[] = "isotherm anchor 1", format_2[] = "isotherm anchor 2";

static void fill_slot(const struct iso_anchor *anchor, uint64_t turn,
                      const struct iso_anchor_state *state, const struct iso_heads *known,
                      uint8_t slot[USED_BYTES])
{
    const uint32_t number = iso_key_ring_newest(anchor->ring, ISO_KEY_ANCHOR);
    const struct iso_seal_label label = slot_label(format_2, anchor->kind, number);
    uint8_t plain[PLAIN_BYTES];
    uint8_t *p = iso_put_u64(plain, turn);
    p = iso_put_u64(p, state->value);
    p = iso_put_bytes(p, state->extra, sizeof state->extra);
    iso_heads_put(known, p);
    (void)iso_put_u32(slot, number);
    iso_seal_close(iso_key_ring_find(anchor->ring, ISO_KEY_ANCHOR, number), &label, plain,
                   sizeof plain, slot + 4);
}

/* Opens a slot of either format. A slot of format 1 has no heads. */
static int open_slot(const struct iso_anchor *anchor, const uint8_t slot[USED_BYTES],
                     uint8_t plain[PLAIN_BYTES])
{
    const uint32_t number = iso_get_u32(slot);
    const struct iso_seal_key *key = iso_key_ring_find(anchor->ring, ISO_KEY_ANCHOR, number);
    const struct iso_seal_label now = slot_label(format_2, anchor->kind, number);
    const struct iso_seal_label before = slot_label(format_1, anchor->kind, number);
    if (!key) {
        return -EBADMSG;
    }
    if (iso_seal_open(key, &now, slot + 4, USED_BYTES - 4, plain) == 0) {
        return 0;
    }
    memset(plain, 0, PLAIN_BYTES);
    return iso_seal_open(key, &before, slot + 4, USED_1_BYTES - 4, plain);
}

/* Uses the slot if it is intact and newer than the one used so far. */
static void try_slot(struct iso_anchor *anchor, const uint8_t slot[USED_BYTES], bool *found)
{
    uint8_t plain[PLAIN_BYTES];
    if (open_slot(anchor, slot, plain)) {
        return;
    }
    const uint64_t turn = iso_get_u64(plain);
    if (!*found || turn > anchor->turn) {
        anchor->turn = turn;
        anchor->state.value = iso_get_u64(plain + 8);
        memcpy(anchor->state.extra, plain + 16, sizeof anchor->state.extra);
        anchor->known = iso_heads_get(plain + PLAIN_1_BYTES);
        *found = true;
    }
}

static int read_slots(struct iso_anchor *anchor, struct iso_fault *fault)
{
    bool found = false;
    for (int i = 0; i < 2; i++) {
        uint8_t slot[USED_BYTES];
        const ssize_t n = pread(anchor->fd, slot, sizeof slot, (off_t)i * SLOT_BYTES);
        if (n < 0) {
            return iso_storage_refused(anchor->path, -errno, fault);
        }
        if (n == sizeof slot) {
            try_slot(anchor, slot, &found);
        }
    }
    return found ? 0
                 : iso_fault_set_code(fault, ISO_FAULT_ANCHOR_DAMAGED, -EBADMSG,
                                      "%s: damaged, or the anchor of another store", anchor->path);
}

static int new_anchor(const char *path, const char *kind, const struct iso_key_ring *ring,
                      bool sync, struct iso_anchor **out, struct iso_fault *fault)
{
    struct iso_anchor *anchor = calloc(1, sizeof *anchor);
    if (!anchor || !(anchor->path = strdup(path))) {
        free(anchor);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    anchor->fd = -1;
    anchor->kind = kind;
    anchor->ring = ring;
    anchor->sync = sync;
    *out = anchor;
    return 0;
}

int iso_anchor_open(const char *path, const char *kind, const struct iso_key_ring *ring, bool sync,
                    struct iso_anchor **out, struct iso_fault *fault)
{
    struct iso_anchor *anchor = NULL;
    int error = new_anchor(path, kind, ring, sync, &anchor, fault);
    if (error) {
        return error;
    }
    struct iso_fault why = {.text = ""};
    error = iso_file_open(path, O_RDWR, 2 * SLOT_BYTES, &anchor->fd, &why);
    if (error && error != -ENOENT) {
        (void)iso_fault_set_code(fault, why.code, error, "%s", why.text);
        error = iso_storage_reword(path, error, fault);
    }
    if (!error) {
        error = read_slots(anchor, fault);
    }
    /* A power failure may still undo a write that is only in the cache. The other stores must learn
     * of it only when it is on the disk (heads.h). */
    if (!error && sync && iso_disk_wait_fdatasync(anchor->fd)) {
        error = iso_storage_refused(path, -errno, fault);
    }
    if (error) {
        iso_anchor_close(anchor);
        return error;
    }
    *out = anchor;
    return 0;
}

int iso_anchor_make(const char *path, const char *kind, const struct iso_key_ring *ring, bool sync,
                    const struct iso_anchor_state *state, struct iso_anchor **out,
                    struct iso_fault *fault)
{
    struct iso_anchor *anchor = NULL;
    uint8_t file[2 * SLOT_BYTES] = {0};
    const struct iso_heads known = iso_heads_now(iso_key_ring_board(ring));
    int error = new_anchor(path, kind, ring, sync, &anchor, fault);
    if (error) {
        return error;
    }
    fill_slot(anchor, 0, state, &known, file);
    fill_slot(anchor, 1, state, &known, file + SLOT_BYTES);
    error = iso_data_file_replace(path, file, sizeof file, fault);
    iso_anchor_close(anchor);
    if (error) {
        return error;
    }
    error = iso_anchor_open(path, kind, ring, sync, out, fault);
    return error == -ENOENT ? -EIO : error;
}

void iso_anchor_close(struct iso_anchor *anchor)
{
    if (anchor) {
        if (anchor->fd >= 0) {
            (void)close(anchor->fd);
        }
        free(anchor->path);
        free(anchor);
    }
}

const struct iso_anchor_state *iso_anchor_state(const struct iso_anchor *anchor)
{
    return &anchor->state;
}

const struct iso_heads *iso_anchor_known(const struct iso_anchor *anchor)
{
    return &anchor->known;
}

int iso_anchor_set(struct iso_anchor *anchor, const struct iso_anchor_state *state,
                   struct iso_fault *fault)
{
    uint8_t slot[USED_BYTES];
    const uint64_t turn = anchor->turn + 1;
    const struct iso_heads known = iso_heads_now(iso_key_ring_board(anchor->ring));
    fill_slot(anchor, turn, state, &known, slot);
    const ssize_t n = pwrite(anchor->fd, slot, sizeof slot, (off_t)(turn & 1) * SLOT_BYTES);
    if (n != sizeof slot || (anchor->sync && iso_disk_wait_fdatasync(anchor->fd))) {
        const bool cut_short = n >= 0 && n != sizeof slot;
        (void)iso_storage_refused(anchor->path, cut_short ? -ENOSPC : -errno, fault);
        return -EIO;
    }
    anchor->turn = turn;
    anchor->state = *state;
    anchor->known = known;
    return 0;
}
