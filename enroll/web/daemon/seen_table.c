#include "enroll/web/daemon/seen_table.h"

#include <sodium.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static uint64_t hash_of(const struct web_seen_table *table, const char *name)
{
    uint64_t hash;
    _Static_assert(crypto_shorthash_BYTES == sizeof hash, "the hash is one number");
    _Static_assert(crypto_shorthash_KEYBYTES == sizeof table->key, "the key of the hash");
    (void)crypto_shorthash((unsigned char *)&hash, (const unsigned char *)name, strlen(name),
                           table->key);
    return hash;
}

/* The place of the first entry that is not before this hash. */
static size_t place_of(const struct web_seen_table *table, uint64_t hash)
{
    size_t from = 0, to = table->n;
    while (from < to) {
        const size_t middle = (from + to) / 2;
        if (table->entries[middle].name < hash) {
            from = middle + 1;
        } else {
            to = middle;
        }
    }
    return from;
}

static bool is_at(const struct web_seen_table *table, size_t place, uint64_t hash)
{
    return place < table->n && table->entries[place].name == hash;
}

static bool make_room(struct web_seen_table *table)
{
    if (table->n < table->room) {
        return true;
    }
    const size_t room = table->room ? 2 * table->room : 64;
    struct web_seen *entries = room > WEB_SEEN_MOST
                                   ? NULL
                                   : realloc(table->entries, room * sizeof *entries);
    if (!entries) {
        return false;
    }
    table->entries = entries;
    table->room = room;
    return true;
}

static void take_out(struct web_seen_table *table, size_t place)
{
    table->n--;
    memmove(table->entries + place, table->entries + place + 1,
            (table->n - place) * sizeof *table->entries);
}

void web_seen_table_init(struct web_seen_table *table)
{
    *table = (struct web_seen_table){.n = 0};
    crypto_shorthash_keygen(table->key);
}

void web_seen_table_done(struct web_seen_table *table)
{
    free(table->entries);
    *table = (struct web_seen_table){.n = 0};
}

void web_seen_table_clear(struct web_seen_table *table)
{
    table->n = 0;
}

int64_t web_seen_table_find(const struct web_seen_table *table, const char *name)
{
    const uint64_t hash = hash_of(table, name);
    const size_t place = place_of(table, hash);
    return is_at(table, place, hash) ? table->entries[place].time_s : 0;
}

void web_seen_table_note(struct web_seen_table *table, const char *name, int64_t time_s)
{
    const uint64_t hash = hash_of(table, name);
    const size_t place = place_of(table, hash);
    if (is_at(table, place, hash)) {
        int64_t *known_s = &table->entries[place].time_s;
        *known_s = time_s > *known_s ? time_s : *known_s;
    } else if (make_room(table)) {
        memmove(table->entries + place + 1, table->entries + place,
                (table->n - place) * sizeof *table->entries);
        table->entries[place] = (struct web_seen){hash, time_s};
        table->n++;
    }
}

void web_seen_table_rename(struct web_seen_table *table, const char *before, const char *after,
                           int64_t time_s)
{
    const int64_t seen_s = web_seen_table_find(table, before);
    if (seen_s > 0 && seen_s <= time_s && strcmp(before, after) != 0) {
        web_seen_table_remove(table, before, time_s);
        web_seen_table_note(table, after, seen_s);
    }
}

void web_seen_table_remove(struct web_seen_table *table, const char *name, int64_t time_s)
{
    const uint64_t hash = hash_of(table, name);
    const size_t place = place_of(table, hash);
    if (is_at(table, place, hash) && table->entries[place].time_s <= time_s) {
        take_out(table, place);
    }
}
