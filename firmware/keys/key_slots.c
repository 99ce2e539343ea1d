#include "firmware/keys/key_slots.h"

#include <sodium.h>
#include <stddef.h>

static uint32_t use_of(const struct iso_key_slot *slot)
{
    return atomic_load_explicit(&slot->use, memory_order_acquire);
}

void iso_key_slots_list(const struct iso_key_slots *slots, struct iso_key_list *out)
{
    *out = (struct iso_key_list){.next = slots->next};
    for (size_t i = 0; i < ISO_KEY_RING_MOST; i++) {
        const struct iso_key_slot *slot = &slots->slots[i];
        const uint32_t use = use_of(slot);
        if (use) {
            out->entries[out->n++] = (struct iso_key_entry){use, slot->number, slot->key};
        }
    }
}

/* Keeps the key of a slot if it is on the list, and takes it off the list. Otherwise drops it. */
static void keep_or_drop(struct iso_key_slot *slot, struct iso_key_list *keys)
{
    const uint32_t use = use_of(slot);
    for (uint32_t i = 0; use && i < keys->n; i++) {
        if (keys->entries[i].use == use && keys->entries[i].number == slot->number) {
            keys->entries[i].use = 0;
            return;
        }
    }
    if (use) {
        atomic_store_explicit(&slot->use, 0, memory_order_release);
        iso_seal_key_wipe(&slot->key);
    }
}

static void fill(struct iso_key_slot *slot, const struct iso_key_entry *entry)
{
    slot->number = entry->number;
    slot->key = entry->key;
    atomic_store_explicit(&slot->use, entry->use, memory_order_release);
}

void iso_key_slots_take(struct iso_key_slots *slots, struct iso_key_list *keys)
{
    size_t place = 0;
    for (size_t i = 0; i < ISO_KEY_RING_MOST; i++) {
        keep_or_drop(&slots->slots[i], keys);
    }
    for (uint32_t i = 0; i < keys->n; i++) {
        if (keys->entries[i].use) {
            while (use_of(&slots->slots[place])) {
                place++;
            }
            fill(&slots->slots[place], &keys->entries[i]);
        }
    }
    slots->next = keys->next;
    sodium_memzero(keys, sizeof *keys);
}

const struct iso_seal_key *iso_key_slots_find(const struct iso_key_slots *slots,
                                              enum iso_key_use use, uint32_t number)
{
    for (size_t i = 0; i < ISO_KEY_RING_MOST; i++) {
        const struct iso_key_slot *slot = &slots->slots[i];
        if (use_of(slot) == (uint32_t)use && slot->number == number) {
            return &slot->key;
        }
    }
    return NULL;
}

uint32_t iso_key_slots_newest(const struct iso_key_slots *slots, enum iso_key_use use)
{
    uint32_t newest = 0;
    for (size_t i = 0; i < ISO_KEY_RING_MOST; i++) {
        const struct iso_key_slot *slot = &slots->slots[i];
        if (use_of(slot) == (uint32_t)use && slot->number > newest) {
            newest = slot->number;
        }
    }
    return newest;
}
