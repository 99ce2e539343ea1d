/* The keys of a ring in memory. Each key keeps its slot, so that a thread can go on reading a key
 * while another thread makes or drops keys of another use.
 *
 * Only one thread at a time looks for the keys of one use and changes them. Only one thread at a
 * time makes a change; the owner of the slots ensures that. */
#ifndef ISO_FIRMWARE_KEYS_KEY_SLOTS_H
#define ISO_FIRMWARE_KEYS_KEY_SLOTS_H

#include <stdatomic.h>

#include "firmware/keys/key_ring.h"

struct iso_key_entry {
    uint32_t use, number;
    struct iso_seal_key key;
};

/* Keys as they are on the disk, or will be; `next` is the number of the next key. */
struct iso_key_list {
    uint32_t n, next;
    struct iso_key_entry entries[ISO_KEY_RING_MOST];
};

/* All zero: no keys. A slot's number and key are written before its use, and read after it. */
struct iso_key_slots {
    uint32_t next;
    struct iso_key_slot {
        _Atomic uint32_t use; /* 0: the slot is free */
        uint32_t number;
        struct iso_seal_key key;
    } slots[ISO_KEY_RING_MOST];
};

/* The keys in the slots. */
void iso_key_slots_list(const struct iso_key_slots *slots, struct iso_key_list *out);

/* Makes the slots hold the keys of this list. A key that is in a slot already keeps its slot. Wipes
 * the list, and the slots of the keys that are not in it. */
void iso_key_slots_take(struct iso_key_slots *slots, struct iso_key_list *keys);

/* As iso_key_ring_find and iso_key_ring_newest. */
const struct iso_seal_key *iso_key_slots_find(const struct iso_key_slots *slots,
                                              enum iso_key_use use, uint32_t number);
uint32_t iso_key_slots_newest(const struct iso_key_slots *slots, enum iso_key_use use);

#endif
