#include "firmware/fleet/door/fleet_index.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "firmware/fleet/door/fleet.h"

struct iso_fleet_id iso_fleet_request_id(const struct iso_fleet_id *door, const char *store,
                                         int64_t person)
{
    uint8_t bytes[ISO_FLEET_ID_BYTES + 16 + 8];
    uint8_t *p = iso_put_bytes(bytes, door->bytes, sizeof door->bytes);
    memset(p, 0, 16);
    memcpy(p, store, strnlen(store, 16));
    (void)iso_put_u64(p + 16, (uint64_t)person);
    return iso_fleet_id_of(bytes, sizeof bytes);
}

void iso__fleet_index_done(struct iso__fleet_index *index)
{
    free(index->entries);
    *index = (struct iso__fleet_index){.n = 0};
}

struct iso_credential_record iso__fleet_credential(const struct iso_fleet_store *store,
                                                   int64_t person)
{
    size_t size = 0;
    const void *bytes = store->access(store->context, person, &size);
    struct iso_credential_record record = iso_credential_record_new();
    if (bytes && iso_credential_record_get(bytes, size, &record)) {
        record.enabled = false;
    }
    return record;
}

struct iso__fleet_entry iso__fleet_entry_of(const struct iso_credential_record *record,
                                            int64_t person)
{
    struct iso__fleet_entry entry = {
        .person = person,
        .revision = record->fleet.revision,
        .zones = record->fleet.zones,
    };
    memcpy(entry.id.bytes, record->fleet.person, sizeof entry.id.bytes);
    memcpy(entry.templates, record->fleet.templates, sizeof entry.templates);
    return entry;
}

int iso__fleet_index_reserve(struct iso__fleet_index *index, size_t n)
{
    if (n <= index->capacity - index->n) {
        return 0;
    }
    const size_t more = 2 * index->capacity + n + 16;
    void *grown = reallocarray(index->entries, more, sizeof *index->entries);
    if (!grown) {
        return -ENOMEM;
    }
    index->entries = grown;
    index->capacity = more;
    return 0;
}

/* The first entry that does not come before this id. */
static size_t place_of(const struct iso__fleet_index *index, const struct iso_fleet_id *id)
{
    size_t low = 0, high = index->n;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (memcmp(&index->entries[middle].id, id, sizeof *id) < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

struct iso__fleet_entry *iso__fleet_index_find(const struct iso__fleet_index *index,
                                               const struct iso_fleet_id *id)
{
    const size_t at = place_of(index, id);
    return at < index->n && iso_fleet_id_is_same(&index->entries[at].id, id) ? &index->entries[at]
                                                                             : NULL;
}

void iso__fleet_index_put(struct iso__fleet_index *index, const struct iso__fleet_entry *entry)
{
    const size_t at = place_of(index, &entry->id);
    struct iso__fleet_entry *own = &index->entries[at];
    if (at < index->n && iso_fleet_id_is_same(&own->id, &entry->id)) {
        index->n_local -= own->revision == 0;
    } else {
        memmove(own + 1, own, (index->n - at) * sizeof *own);
        index->n++;
    }
    *own = *entry;
    index->n_local += entry->revision == 0;
}

void iso__fleet_index_drop(struct iso__fleet_index *index, const struct iso_fleet_id *id)
{
    struct iso__fleet_entry *own = iso__fleet_index_find(index, id);
    if (own) {
        const size_t at = (size_t)(own - index->entries);
        index->n_local -= own->revision == 0;
        memmove(own, own + 1, (index->n - at - 1) * sizeof *own);
        index->n--;
    }
}

static int by_id(const void *a, const void *b)
{
    const struct iso__fleet_entry *one = a, *other = b;
    return memcmp(&one->id, &other->id, sizeof one->id);
}

int iso__fleet_index_refresh(struct iso__fleet_index *index, const struct iso_fleet_store *store,
                             const struct iso_fleet_id *door, bool *changed)
{
    const struct iso_gallery_version now = store->version(store->context);
    size_t n = 0;
    *changed = now.changes != index->version.changes ||
               strcmp(now.gallery, index->version.gallery) != 0;
    if (!*changed) {
        return 0;
    }
    const struct iso_person *people = store->people(store->context, &n);
    index->n = index->n_local = 0;
    if (iso__fleet_index_reserve(index, n)) {
        index->version = (struct iso_gallery_version){.changes = 0};
        return -ENOMEM;
    }
    for (size_t i = 0; i < n; i++) {
        struct iso_credential_record record = iso__fleet_credential(store, people[i].id);
        struct iso__fleet_entry entry = iso__fleet_entry_of(&record, people[i].id);
        if (!iso_credential_is_of_fleet(&record)) {
            entry.id = iso_fleet_request_id(door, now.gallery, people[i].id);
            index->n_local++;
        }
        iso_credential_record_wipe(&record);
        index->entries[index->n++] = entry;
    }
    if (index->n > 0) {
        qsort(index->entries, index->n, sizeof *index->entries, by_id);
    }
    index->version = now;
    return 0;
}
