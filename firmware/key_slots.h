/* The keys of a ring in memory, each in a slot of its own that it keeps: whoever has found a key
 * can go on reading it while another thread makes or drops keys of another use.
 *
 * The keys of one use belong to one thread at a time: that thread looks for them, and changes them.
 * Changes are made by one thread at a time, for which the owner of the slots sees. */
#ifndef ISO_FIRMWARE_KEY_SLOTS_H
#define ISO_FIRMWARE_KEY_SLOTS_H

#include <stdatomic.h>

#include "firmware/key_ring.h"

struct iso_key_entry {
    uint32_t use, number;
    struct iso_seal_key key;
};

/* Keys as they are on the disk, or are about to be; `next` is the number that the next key gets. */
struct iso_key_list {
    uint32_t n, next;
    struct iso_key_entry entries[ISO_KEY_RING_MOST];
};

/* All zero: no keys. A slot's number and key are written before its use, and read behind it. */
struct iso_key_slots {
    uint32_t next;
    struct iso_key_slot {
        _Atomic uint32_t use; /* 0: free */
        uint32_t number;
        struct iso_seal_key key;
    } slots[ISO_KEY_RING_MOST];
};

/* What the slots hold. */
void iso_key_slots_list(const struct iso_key_slots *slots, struct iso_key_list *out);

/* From now on the slots hold these keys, those that they held already where they were. Wipes the
 * list, and the keys that are dropped. */
void iso_key_slots_take(struct iso_key_slots *slots, struct iso_key_list *keys);

/* As iso_key_ring_find and iso_key_ring_newest. */
const struct iso_seal_key *iso_key_slots_find(const struct iso_key_slots *slots,
                                              enum iso_key_use use, uint32_t number);
uint32_t iso_key_slots_newest(const struct iso_key_slots *slots, enum iso_key_use use);

#endif
