#include "firmware/keys/key_ring.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/file/data_file.h"
#include "drivers/file/directory.h"
#include "drivers/file/storage_fault.h"
#include "firmware/keys/key_ring_state.h"
#include "firmware/keys/master_keys.h"

/* ---- opening ---- */

static void draft_key(struct iso_key_ring *ring, enum iso_key_use use)
{
    ring->draft.entries[ring->draft.n++] = (struct iso_key_entry){
        .use = (uint32_t)use, .number = ring->draft.next++, .key = iso_seal_key_random()};
}

static int make_ring(struct iso_key_ring *ring, struct iso_master_keys *masters,
                     struct iso_fault *fault)
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
    return iso__key_ring_commit(ring, &ring->master, fault);
}

/* Moves the new key from FILE.new to FILE. It may be there already, if the disk reported an error
 * although it moved the file. */
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

/* Completes a change of the key that was interrupted: the second key has opened the ring. */
static int end_change(struct iso_key_ring *ring, const struct iso_master_keys *masters,
                      struct iso_fault *fault)
{
    if (ring->credential) {
        ring->master = masters->keys[0];
        iso_key_slots_list(&ring->slots, &ring->draft);
        return iso__key_ring_commit(ring, &ring->master, fault);
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

static int open_ring(struct iso_key_ring *ring, const struct iso_master_keys *masters,
                     const uint8_t *bytes, size_t size, struct iso_fault *fault)
{
    if (!masters->have[0] && !masters->have[1]) {
        return iso_fault_set_code(fault, ISO_FAULT_KEY_MISSING, -ENOKEY,
                                  "%s: the key %s is gone; without it nothing sealed can be read",
                                  ring->path, ring->file);
    }
    if (masters->have[0] && iso__key_ring_open_with(ring, &masters->keys[0], bytes, size) == 0) {
        ring->master = masters->keys[0];
        forget_change(ring);
        return 0;
    }
    if (masters->have[1] && iso__key_ring_open_with(ring, &masters->keys[1], bytes, size) == 0) {
        return end_change(ring, masters, fault);
    }
    return iso_fault_set_code(fault, ISO_FAULT_KEY_WRONG, -EKEYREJECTED,
                              "%s: damaged, or sealed with another key", ring->path);
}

static int find_keys(struct iso_key_ring *ring, const char *credentials, struct iso_fault *fault)
{
    struct iso_master_keys masters = {.have = {false}};
    void *bytes = NULL;
    size_t size = 0;
    int error = 0;
    if (credentials && *credentials) {
        error = iso_master_keys_of_credentials(credentials, &masters, fault);
        ring->credential = masters.have[0];
    }
    if (!error && !ring->credential) {
        error = iso_master_keys_of_file(ring->file, &masters, fault);
    }
    if (!error) {
        error = iso_data_file_read(ring->path, iso__key_ring_file_bytes(), &bytes, &size, fault);
        if (error == -ENOENT) {
            error = make_ring(ring, &masters, fault);
        } else if (!error) {
            error = open_ring(ring, &masters, bytes, size, fault);
        }
    }
    if (!error) {
        /* A power failure may still undo a write that is only in the cache. The other stores must
         * learn of it only when it is on the disk. */
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
    if (!error) {
        error = find_keys(ring, place->credentials, fault);
    }
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
        sodium_free(ring); /* sodium_free() wipes the memory */
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

static int add_key(struct iso_key_ring *ring, enum iso_key_use use, uint32_t *number,
                   struct iso_fault *fault)
{
    const uint32_t made = ring->draft.next;
    if (ring->draft.n == ISO_KEY_RING_MOST) {
        return iso_fault_set_code(fault, ISO_FAULT_KEY_RING_FULL, -ENOSPC,
                                  "%s: holds %u keys, there is no room for more", ring->path,
                                  ring->draft.n);
    }
    draft_key(ring, use);
    const int error = iso__key_ring_commit(ring, &ring->master, fault);
    if (!error) {
        *number = made;
    }
    return error;
}

/* Begins a change, with a copy of the present keys as the draft. */
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
    const int error = add_key(ring, use, number, fault);
    end_change_of_keys(ring);
    return error;
}

/* Removes the keys of this use with numbers below `number` from the list. Returns true if there
 * were any. */
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
    const int error = take_off(&ring->draft, use, number)
                          ? iso__key_ring_commit(ring, &ring->master, fault)
                          : 0;
    end_change_of_keys(ring);
    return error;
}

/* Completes an earlier change of the key. FILE.new may hold the key with which the ring on the disk
 * is sealed, and the next change would overwrite it. */
static int end_change_before(struct iso_key_ring *ring, struct iso_fault *fault)
{
    int error = 0;
    if (ring->unsure) {
        iso_key_slots_list(&ring->slots, &ring->draft);
        error = iso__key_ring_commit(ring, &ring->master, fault);
    }
    return error || !ring->beside ? error : take_place(ring, fault);
}

int iso_key_ring_renew(struct iso_key_ring *ring, struct iso_fault *fault)
{
    begin_change(ring);
    const int error = iso__key_ring_commit(ring, &ring->master, fault);
    end_change_of_keys(ring);
    return error;
}

/* Changes the key of the appliance. The new key is written to FILE.new before the ring is sealed
 * with it, and replaces the old key afterwards. So the key of the ring is on the disk at all times.
 */
static int change_key(struct iso_key_ring *ring, struct iso_fault *fault)
{
    char beside[PATH_MAX + 8];
    (void)snprintf(beside, sizeof beside, "%s.new", ring->file);
    int error = end_change_before(ring, fault);
    struct iso_seal_key fresh = iso_seal_key_random();
    if (!error) {
        error = iso_data_file_replace(beside, fresh.bytes, sizeof fresh.bytes, fault);
    }
    if (!error) {
        iso_key_slots_list(&ring->slots, &ring->draft);
        error = iso__key_ring_commit(ring, &fresh, fault);
        ring->beside = memcmp(&ring->master, &fresh, sizeof fresh) == 0;
    }
    if (!error) {
        error = take_place(ring, fault);
    }
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
