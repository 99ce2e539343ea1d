#include "firmware/gallery/gallery_memory.h"

#include <errno.h>
#include <sodium.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/gallery/gallery.h"

_Static_assert((int)ISO_GALLERY_TEMPLATES_MAX <= (int)ISO_INDEX_TEMPLATES_MAX,
               "the index takes all templates of a person");

static void free_template(const struct iso_template *tmpl)
{
    struct iso_template *own = (struct iso_template *)(uintptr_t)tmpl;
    if (own) {
        iso_template_wipe(own);
        free(own);
    }
}

void iso_gallery_memory_done(struct iso_gallery_memory *memory)
{
    for (size_t i = 0; i < memory->n_entries; i++) {
        free_template(memory->entries[i].tmpl);
    }
    free(memory->entries);
    iso_site_index_free(memory->site);
    sodium_memzero(memory->people, memory->n_people * sizeof *memory->people);
    free(memory->people);
    iso_gallery_access_done(&memory->access);
    *memory = (struct iso_gallery_memory){0};
}

/* ---- room ---- */

/* Makes room for `least` items in an array. */
static int reserve_items(void **items, size_t item_size, size_t least, size_t *capacity)
{
    if (least <= *capacity) {
        return 0;
    }
    const size_t doubled = *capacity ? 2 * *capacity : 16;
    const size_t more = least > doubled ? least : doubled;
    void *grown = reallocarray(*items, more, item_size);
    if (!grown) {
        return -ENOMEM;
    }
    *items = grown;
    *capacity = more;
    return 0;
}

int iso_gallery_memory_reserve(struct iso_gallery_memory *memory, int n)
{
    void *entries = memory->entries;
    if (memory->site) {
        return iso_site_index_reserve(memory->site, (size_t)n);
    }
    const int error = reserve_items(&entries, sizeof *memory->entries,
                                    memory->n_entries + (size_t)n, &memory->entries_capacity);
    memory->entries = entries;
    return error;
}

/* ---- one template ---- */

static int keep_vector(const struct iso_metric *metric, const struct iso_template *tmpl,
                       struct iso_gallery_kept *out)
{
    out->vector.n = 0;
    const int error = iso_metric_project(metric, tmpl, &out->vector);
    return error == -ENODATA ? 0 : error;
}

/* Reads a template in the form in which it is kept: the template itself, or its vector alone. */
static int read_template(const struct iso_gallery_memory *memory, const void *bytes, size_t size,
                         struct iso_gallery_kept *kept)
{
    kept->tmpl = malloc(sizeof *kept->tmpl);
    if (!kept->tmpl) {
        return -ENOMEM;
    }
    int error = iso_template_parse(bytes, size, kept->tmpl);
    if (!error && kept->tmpl->algorithm != memory->algorithm) {
        error = -EINVAL;
    }
    if (!error && memory->metric) {
        error = keep_vector(memory->metric, kept->tmpl, kept);
    }
    memcpy(kept->sensor, kept->tmpl->sensor, sizeof kept->sensor);
    if (error || memory->metric) {
        iso_template_wipe(kept->tmpl);
        free(kept->tmpl);
        kept->tmpl = NULL;
    }
    return error;
}

int iso__gallery_memory_read(struct iso_gallery_memory *memory, const void *bytes, size_t size,
                             struct iso_gallery_kept *out)
{
    struct iso_gallery_kept kept = {.tmpl = NULL};
    int error = read_template(memory, bytes, size, &kept);
    if (!error) {
        error = iso_gallery_memory_reserve(memory, 1);
    }
    if (error) {
        iso_gallery_memory_discard(&kept);
        return error;
    }
    *out = kept; /* NOLINT(clang-analyzer-unix.Malloc): the caller owns the copy */
    sodium_memzero(&kept, sizeof kept);
    return 0;
}

int iso_gallery_memory_prepare(struct iso_gallery_memory *memory, const void *bytes, size_t size,
                               struct iso_gallery_kept *out)
{
    int error = iso__gallery_memory_read(memory, bytes, size, out);
    if (!error && iso_gallery_memory_reserve_people(memory, 1)) {
        iso_gallery_memory_discard(out);
        error = -ENOMEM;
    }
    return error;
}

int iso_gallery_memory_reserve_people(struct iso_gallery_memory *memory, size_t n)
{
    void *people = memory->people;
    const int error = reserve_items(&people, sizeof *memory->people, memory->n_people + n,
                                    &memory->people_capacity);
    memory->people = people;
    return error;
}

void iso_gallery_memory_discard(struct iso_gallery_kept *kept)
{
    free_template(kept->tmpl);
    sodium_memzero(kept, sizeof *kept);
}

/* Inserts an entry after the last one of this person, or of a person who was enrolled earlier. The
 * caller has made room. */
static void insert_entry(struct iso_gallery_memory *memory, int64_t person,
                         const struct iso_template *tmpl)
{
    size_t at = memory->n_entries;
    while (at > 0 && memory->entries[at - 1].person > person) {
        at--;
    }
    memmove(memory->entries + at + 1, memory->entries + at,
            (memory->n_entries - at) * sizeof *memory->entries);
    memory->entries[at] = (struct iso_search_entry){.person = person, .tmpl = tmpl};
    memory->n_entries++;
}

int iso__gallery_memory_insert(struct iso_gallery_memory *memory, int64_t person,
                               struct iso_gallery_kept *kept)
{
    int error = 0;
    if (!memory->site) {
        insert_entry(memory, person, kept->tmpl);
        kept->tmpl = NULL;
    } else if (kept->vector.n > 0) {
        error = iso_site_index_add(memory->site, person, (uint64_t)kept->number, kept->sensor,
                                   &kept->vector);
    }
    iso_gallery_memory_discard(kept);
    return error;
}

void iso_gallery_memory_add(struct iso_gallery_memory *memory, const struct iso_person *row,
                            struct iso_gallery_kept *kept)
{
    if (!iso_gallery_memory_find(memory, row->id)) {
        iso_gallery_memory_put_person(memory, row, 0);
    }
    struct iso_person *own = iso_gallery_memory_find(memory, row->id);
    own->valid_from_s = row->valid_from_s;
    own->valid_until_s = row->valid_until_s;
    own->templates++;
    own->usable++;
    memory->may_be_learned = true;
    (void)!iso__gallery_memory_insert(memory, row->id, kept);
}

/* ---- people ---- */

struct iso_person *iso_gallery_memory_find(const struct iso_gallery_memory *memory, int64_t person)
{
    size_t low = 0, high = memory->n_people;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (memory->people[middle].id < person) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < memory->n_people && memory->people[low].id == person ? &memory->people[low] : NULL;
}

void iso_gallery_memory_remove(struct iso_gallery_memory *memory, int64_t person)
{
    struct iso_person *own = iso_gallery_memory_find(memory, person);
    size_t kept = 0;
    for (size_t i = 0; i < memory->n_entries; i++) {
        if (memory->entries[i].person == person) {
            free_template(memory->entries[i].tmpl);
        } else {
            memory->entries[kept++] = memory->entries[i];
        }
    }
    memory->n_entries = kept;
    if (memory->site) {
        iso_site_index_remove(memory->site, person);
    }
    iso_gallery_access_remove(&memory->access, person);
    if (own) {
        const size_t behind = memory->n_people - (size_t)(own - memory->people) - 1;
        memmove(own, own + 1, behind * sizeof *own);
        memory->n_people--;
        sodium_memzero(&memory->people[memory->n_people], sizeof *memory->people);
    }
}
