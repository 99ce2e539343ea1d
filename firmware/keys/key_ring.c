#include "firmware/keys/key_ring.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/bytes.h"
#include "drivers/file/data_file.h"
#include "drivers/file/directory.h"
#include "drivers/file/file.h"
#include "drivers/file/storage_fault.h"
#include "firmware/keys/key_slots.h"

/* The file: magic, then sealed: n u32, next number u32, number of the file u64, heads (heads.h),
 * n x (use u32, number u32, key[32]). Format 1, which is still read, has no number and no heads. */
static const char magic[8] = {'I', 'S', 'O', 'K', 'E', 'Y', 'S', '2'};

enum {
    ENTRY_BYTES = 8 + ISO_SEAL_KEY_BYTES,
    KNOWN_BYTES = 8 + ISO_HEADS_BYTES,
    PLAIN_MAX_BYTES = 8 + KNOWN_BYTES + ISO_KEY_RING_MOST * ENTRY_BYTES,
    FILE_MAX_BYTES = sizeof magic + PLAIN_MAX_BYTES + ISO_SEAL_OVERHEAD,
};

struct iso_key_ring {
    char path[PATH_MAX], file[PATH_MAX];
    bool credential;
    bool beside;              /* the key has not got its place yet: it is in FILE.new */
    bool unsure;              /* the disk refused the ring: which one it holds is not known */
    pthread_mutex_t changing; /* of what follows, but for looking into the slots */
    struct iso_seal_key master;
    struct iso_key_slots slots;
    struct iso_key_list draft; /* what is about to be written */
    uint64_t number;           /* of the file on the disk; 0: of format 1 */
    struct iso_heads_board *board;
};

/* ---- the ring's file ---- */

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

/* After `error` of writing the ring: the new one may be in its place nevertheless, and is then to
 * stay there. The old one may be there too, or it may not be known: then the old one holds, which
 * is a part of both or is written again before it matters. */
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

/* Writes the draft, sealed with `master`; only then both hold. */
static int commit(struct iso_key_ring *ring, const struct iso_seal_key *master,
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

static int open_with(struct iso_key_ring *ring, const struct iso_seal_key *master,
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
    int error = iso_seal_open(master, &label, bytes + sizeof magic, sealed, plain);
    struct iso_heads known = {{0}, {0}};
    error = error ? error
                  : get_keys(plain, sealed - ISO_SEAL_OVERHEAD, format, &ring->draft, &ring->number,
                             &known);
    sodium_memzero(plain, sizeof plain);
    if (!error) {
        iso_key_slots_take(&ring->slots, &ring->draft);
        iso_heads_found(ring->board, ISO_HEAD_RING, ring->path, ring->number);
        iso_heads_claim(ring->board, ring->path, &known);
    }
    return error ? -EKEYREJECTED : 0;
}

/* ---- the appliance's key ---- */

/* The first and the second choice; either may be missing. */
struct masters {
    struct iso_seal_key keys[2];
    bool have[2];
};

static int check_private(const char *path, struct iso_fault *fault)
{
    struct stat status;
    if (stat(path, &status)) {
        return iso_file_fault(path, -errno, fault);
    }
    return status.st_mode & 077
               ? iso_fault_set_code(fault, ISO_FAULT_KEY_EXPOSED, -EACCES,
                                    "%s: others can read this key: chmod 600", path)
               : 0;
}

/* 0 with *have false if there is no such file. */
static int read_key(const char *path, struct iso_seal_key *out, bool *have, struct iso_fault *fault)
{
    void *bytes = NULL;
    size_t size = 0;
    *have = false;
    int error = iso_data_file_read(path, 1 << 12, &bytes, &size, fault);
    if (error) {
        return error == -ENOENT ? 0 : error;
    }
    if (size == sizeof out->bytes) {
        memcpy(out->bytes, bytes, size);
        *have = true;
    } else {
        error = iso_fault_set_code(fault, ISO_FAULT_KEY_WRONG, -EINVAL,
                                   "%s: a key has %zu bytes, this has %zu", path, sizeof out->bytes,
                                   size);
    }
    sodium_memzero(bytes, size);
    free(bytes);
    return error;
}

static int read_credentials(const char *directory, struct masters *out, struct iso_fault *fault)
{
    static const char *const names[] = {"isotherm.key", "isotherm.key.old"};
    int error = 0;
    for (size_t i = 0; !error && i < 2; i++) {
        char path[PATH_MAX];
        if (snprintf(path, sizeof path, "%s/%s", directory, names[i]) >= PATH_MAX) {
            return iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", directory);
        }
        error = read_key(path, &out->keys[i], &out->have[i], fault);
    }
    return error;
}

/* The key's file, and what a change of it that was cut short has left beside: a whole key or not.
 */
static int read_files(const char *file, struct masters *out, struct iso_fault *fault)
{
    char beside[PATH_MAX + 8];
    (void)snprintf(beside, sizeof beside, "%s.new", file);
    int error = read_key(file, &out->keys[0], &out->have[0], fault);
    if (!error && out->have[0]) {
        error = check_private(file, fault);
    }
    if (!error && read_key(beside, &out->keys[1], &out->have[1], NULL)) {
        out->have[1] = false;
    }
    return error;
}

/* ---- opening ---- */

static void draft_key(struct iso_key_ring *ring, enum iso_key_use use)
{
    ring->draft.entries[ring->draft.n++] = (struct iso_key_entry){
        .use = (uint32_t)use, .number = ring->draft.next++, .key = iso_seal_key_random()};
}

static int make_ring(struct iso_key_ring *ring, struct masters *masters, struct iso_fault *fault)
{
    if (!masters->have[0]) {
        masters->keys[0] = iso_seal_key_random();
        const int error = iso_data_file_replace(ring->file, masters->keys[0].bytes,
                                                ISO_SEAL_KEY_BYTES, fault);
        if (error) {
            return error;
        }
    }
    ring->master = masters->keys[0];
    ring->draft = (struct iso_key_list){.next = 1};
    draft_key(ring, ISO_KEY_ANCHOR);
    draft_key(ring, ISO_KEY_SIGN);
    draft_key(ring, ISO_KEY_RECEIVE);
    return commit(ring, &ring->master, fault);
}

/* Moves the key from beside its place to it. It may be there already, if the disk said that it was
 * not moved. */
static int take_place(struct iso_key_ring *ring, struct iso_fault *fault)
{
    char beside[PATH_MAX + 8];
    (void)snprintf(beside, sizeof beside, "%s.new", ring->file);
    if (rename(beside, ring->file)) {
        const int error = -errno;
        if (!iso_data_file_holds(ring->file, ring->master.bytes, sizeof ring->master.bytes)) {
            return iso_storage_refused(ring->file, error, fault);
        }
    }
    const int error = iso_directory_sync(ring->file, fault);
    ring->beside = error != 0;
    return error;
}

/* The second choice opened it: a change of the appliance's key was not over. */
static int end_change(struct iso_key_ring *ring, const struct masters *masters,
                      struct iso_fault *fault)
{
    if (ring->credential) {
        ring->master = masters->keys[0];
        iso_key_slots_list(&ring->slots, &ring->draft);
        return commit(ring, &ring->master, fault);
    }
    ring->master = masters->keys[1];
    return take_place(ring, fault);
}

static void forget_change(const struct iso_key_ring *ring)
{
    char beside[PATH_MAX + 8];
    (void)snprintf(beside, sizeof beside, "%s.new", ring->file);
    if (!ring->credential) {
        (void)unlink(beside);
    }
}

static int open_ring(struct iso_key_ring *ring, const struct masters *masters, const uint8_t *bytes,
                     size_t size, struct iso_fault *fault)
{
    if (!masters->have[0] && !masters->have[1]) {
        return iso_fault_set_code(fault, ISO_FAULT_KEY_MISSING, -ENOKEY,
                                  "%s: the key %s is gone; without it nothing sealed can be read",
                                  ring->path, ring->file);
    }
    if (masters->have[0] && open_with(ring, &masters->keys[0], bytes, size) == 0) {
        ring->master = masters->keys[0];
        forget_change(ring);
        return 0;
    }
    if (masters->have[1] && open_with(ring, &masters->keys[1], bytes, size) == 0) {
        return end_change(ring, masters, fault);
    }
    return iso_fault_set_code(fault, ISO_FAULT_KEY_WRONG, -EKEYREJECTED,
                              "%s: damaged, or sealed with another key", ring->path);
}

static int find_keys(struct iso_key_ring *ring, const char *credentials, struct iso_fault *fault)
{
    struct masters masters = {.have = {false}};
    void *bytes = NULL;
    size_t size = 0;
    int error = 0;
    if (credentials && *credentials) {
        error = read_credentials(credentials, &masters, fault);
        ring->credential = masters.have[0];
    }
    if (!error && !ring->credential) {
        error = read_files(ring->file, &masters, fault);
    }
    if (!error) {
        error = iso_data_file_read(ring->path, FILE_MAX_BYTES, &bytes, &size, fault);
        error = error == -ENOENT ? make_ring(ring, &masters, fault)
                : error          ? error
                                 : open_ring(ring, &masters, bytes, size, fault);
    }
    if (!error) { /* what a power cut may still take away is not told to the other stores */
        error = iso_directory_sync(ring->path, fault);
    }
    free(bytes);
    sodium_memzero(&masters, sizeof masters);
    return error;
}

int iso_key_ring_open(const struct iso_key_place *place, struct iso_key_ring **out,
                      struct iso_fault *fault)
{
    int error = iso_seal_start(fault);
    if (error) {
        return error;
    }
    struct iso_key_ring *ring = sodium_malloc(sizeof *ring);
    if (!ring) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", place->ring);
    }
    memset(ring, 0, sizeof *ring);
    (void)pthread_mutex_init(&ring->changing, NULL);
    if (iso_heads_board_new(&ring->board)) {
        iso_key_ring_close(ring);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", place->ring);
    }
    if (snprintf(ring->path, sizeof ring->path, "%s", place->ring) >= PATH_MAX ||
        snprintf(ring->file, sizeof ring->file, "%s", place->file) >= PATH_MAX) {
        error = iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", place->ring);
    }
    error = error ? error : find_keys(ring, place->credentials, fault);
    if (error) {
        iso_key_ring_close(ring);
        return error;
    }
    *out = ring;
    return 0;
}

void iso_key_ring_close(struct iso_key_ring *ring)
{
    if (ring) {
        iso_heads_board_free(ring->board);
        (void)pthread_mutex_destroy(&ring->changing);
        sodium_free(ring); /* which wipes */
    }
}

/* ---- use ---- */

struct iso_heads_board *iso_key_ring_board(const struct iso_key_ring *ring)
{
    return ring->board;
}

const struct iso_seal_key *iso_key_ring_find(const struct iso_key_ring *ring, enum iso_key_use use,
                                             uint32_t number)
{
    return iso_key_slots_find(&ring->slots, use, number);
}

uint32_t iso_key_ring_newest(const struct iso_key_ring *ring, enum iso_key_use use)
{
    return iso_key_slots_newest(&ring->slots, use);
}

static int add(struct iso_key_ring *ring, enum iso_key_use use, uint32_t *number,
               struct iso_fault *fault)
{
    const uint32_t made = ring->draft.next;
    if (ring->draft.n == ISO_KEY_RING_MOST) {
        return iso_fault_set_code(fault, ISO_FAULT_KEY_RING_FULL, -ENOSPC,
                                  "%s: holds %u keys, there is no room for more", ring->path,
                                  ring->draft.n);
    }
    draft_key(ring, use);
    const int error = commit(ring, &ring->master, fault);
    if (!error) {
        *number = made;
    }
    return error;
}

/* A change begins with a draft of what there is. */
static void begin_change(struct iso_key_ring *ring)
{
    (void)pthread_mutex_lock(&ring->changing);
    iso_key_slots_list(&ring->slots, &ring->draft);
}

static void end_change_of_keys(struct iso_key_ring *ring)
{
    sodium_memzero(&ring->draft, sizeof ring->draft);
    (void)pthread_mutex_unlock(&ring->changing);
}

int iso_key_ring_add(struct iso_key_ring *ring, enum iso_key_use use, uint32_t *number,
                     struct iso_fault *fault)
{
    begin_change(ring);
    const int error = add(ring, use, number, fault);
    end_change_of_keys(ring);
    return error;
}

/* Takes the keys of this use with numbers below `number` off the list; true if there were any. */
static bool take_off(struct iso_key_list *keys, enum iso_key_use use, uint32_t number)
{
    const uint32_t n = keys->n;
    keys->n = 0;
    for (uint32_t i = 0; i < n; i++) {
        const struct iso_key_entry *entry = &keys->entries[i];
        if (entry->use != (uint32_t)use || entry->number >= number) {
            keys->entries[keys->n++] = *entry;
        }
    }
    return keys->n < n;
}

int iso_key_ring_drop(struct iso_key_ring *ring, enum iso_key_use use, uint32_t number,
                      struct iso_fault *fault)
{
    begin_change(ring);
    const int error = take_off(&ring->draft, use, number) ? commit(ring, &ring->master, fault) : 0;
    end_change_of_keys(ring);
    return error;
}

/* Nothing may be left of a change before: the key in FILE.new may be the one that the ring on the
 * disk is sealed with, and is replaced now. */
static int end_change_before(struct iso_key_ring *ring, struct iso_fault *fault)
{
    int error = 0;
    if (ring->unsure) {
        iso_key_slots_list(&ring->slots, &ring->draft);
        error = commit(ring, &ring->master, fault);
    }
    return error || !ring->beside ? error : take_place(ring, fault);
}

int iso_key_ring_renew(struct iso_key_ring *ring, struct iso_fault *fault)
{
    begin_change(ring);
    const int error = commit(ring, &ring->master, fault);
    end_change_of_keys(ring);
    return error;
}

/* The new key stands beside the old one before the ring is sealed with it, and takes its place
 * afterwards: the ring always has its key. */
static int change_key(struct iso_key_ring *ring, struct iso_fault *fault)
{
    char beside[PATH_MAX + 8];
    (void)snprintf(beside, sizeof beside, "%s.new", ring->file);
    int error = end_change_before(ring, fault);
    struct iso_seal_key fresh = iso_seal_key_random();
    error = error ? error : iso_data_file_replace(beside, fresh.bytes, sizeof fresh.bytes, fault);
    if (!error) {
        iso_key_slots_list(&ring->slots, &ring->draft);
        error = commit(ring, &fresh, fault);
        ring->beside = memcmp(&ring->master, &fresh, sizeof fresh) == 0;
    }
    error = error ? error : take_place(ring, fault);
    iso_seal_key_wipe(&fresh);
    return error;
}

int iso_key_ring_change_key(struct iso_key_ring *ring, struct iso_fault *fault)
{
    if (ring->credential) {
        return iso_fault_set(fault, -EPERM, "the appliance's key is a credential of the system");
    }
    begin_change(ring);
    const int error = change_key(ring, fault);
    end_change_of_keys(ring);
    return error;
}

bool iso_key_ring_has_credential(const struct iso_key_ring *ring)
{
    return ring->credential;
}
