#include "firmware/gallery/gallery_memory.h"

#include <errno.h>
#include <sodium.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/gallery/gallery.h"
#include "firmware/gallery/gallery_seal.h"
#include "firmware/site/site_batch.h"

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

/* Prepares a template in the form in which it is kept, and room for it. The people stay at their
 * addresses. */
static int prepare_template(struct iso_gallery_memory *memory, const void *bytes, size_t size,
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
    int error = prepare_template(memory, bytes, size, out);
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

/* Adds the template, or its vector, to the memory. The caller has made room, and nobody has more
 * templates than an index takes. */
static int insert_vector(struct iso_gallery_memory *memory, int64_t person,
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
    (void)!insert_vector(memory, row->id, kept);
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

/* ---- all of the database ---- */

struct loading {
    struct iso_gallery_db *db;
    struct iso_site_batch *batch; /* with a metric: what adds the vectors */
    const struct iso_work_listener *listener;
    struct iso_gallery_memory memory;
};

static int load_person(void *context, const struct iso_person *person, struct iso_fault *fault)
{
    struct iso_gallery_memory *memory = &((struct loading *)context)->memory;
    if (iso_gallery_memory_reserve_people(memory, 1)) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    struct iso_person *own = &memory->people[memory->n_people];
    *own = *person;
    if (iso_person_name_key(own->name, &own->key)) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    memory->n_people++;
    return 0;
}

/* Loads a template that the running algorithm can use. */
static int load_usable(struct loading *loading, struct iso_person *person, int64_t number,
                       const void *bytes, size_t size)
{
    struct iso_gallery_kept kept;
    int error = loading->batch ? iso_site_batch_add(loading->batch, person->id, number, bytes, size)
                               : prepare_template(&loading->memory, bytes, size, &kept);
    if (!error && !loading->batch) {
        error = insert_vector(&loading->memory, person->id, &kept);
    }
    person->usable += !error;
    return error;
}

/* Checks that the bytes are a template of this algorithm, which is not the running one. */
static int check_unusable(const void *bytes, size_t size, uint32_t algorithm)
{
    struct iso_template_facts facts;
    const int error = iso_template_check(bytes, size, &facts);
    if (error) {
        return error;
    }
    return facts.algorithm == algorithm ? 0 : -EBADMSG;
}

/* What the error of a template means for loading. */
static int template_result(const struct loading *loading, int error, struct iso_fault *fault)
{
    if (error == -ENOMEM) {
        return iso_fault_set(fault, error, "gallery: out of memory");
    }
    const bool damaged = error && error != -EPROTONOSUPPORT;
    return damaged ? iso_gallery_db_damaged(loading->db, "a template cannot be read", fault) : 0;
}

static int load_template(void *context, const struct iso_gallery_place *place, const void *bytes,
                         size_t size, struct iso_fault *fault)
{
    struct loading *loading = context;
    struct iso_person *person = iso_gallery_memory_find(&loading->memory, place->person);
    if (!person) {
        return iso_gallery_db_damaged(loading->db, "a template belongs to nobody", fault);
    }
    person->templates++;
    iso_work_step(loading->listener, (uint64_t)(person - loading->memory.people) + 1,
                  loading->memory.n_people);
    const int error = place->algorithm == loading->memory.algorithm
                          ? load_usable(loading, person, place->number, bytes, size)
                          : check_unusable(bytes, size, place->algorithm);
    return template_result(loading, error, fault);
}

static int load_access(void *context, const struct iso_gallery_place *place, const void *bytes,
                       size_t size, struct iso_fault *fault)
{
    struct loading *loading = context;
    if (place->person != ISO_GALLERY_SITE && place->person != ISO_GALLERY_FLEET &&
        !iso_gallery_memory_find(&loading->memory, place->person)) {
        return iso_gallery_db_damaged(loading->db, "an access record belongs to nobody", fault);
    }
    const int error = iso_gallery_access_load(&loading->memory.access, place->person,
                                              place->algorithm, bytes, size);
    if (error == -ENOMEM) {
        return iso_fault_set(fault, error, "gallery: out of memory");
    }
    return error ? iso_gallery_db_damaged(loading->db, "an access record is not whole", fault) : 0;
}

/* Sorts by key, and people with the same key by spelling. */
static int by_name(const void *a, const void *b)
{
    const struct iso_person *one = *(const struct iso_person *const *)a;
    const struct iso_person *other = *(const struct iso_person *const *)b;
    const int order = memcmp(&one->key, &other->key, sizeof one->key);
    return order ? order : strcmp(one->name, other->name);
}

/* Two people cannot have the same spelling. They can have two spellings of one name in a gallery
 * that was written when the case of letters made a difference. Such people stay, and are
 * counted. */
static int check_names(struct loading *loading, struct iso_fault *fault)
{
    struct iso_gallery_memory *memory = &loading->memory;
    const size_t n = memory->n_people;
    int error = 0;
    const struct iso_person **people = calloc(n ? n : 1, sizeof *people);
    if (!people) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    for (size_t i = 0; i < n; i++) {
        people[i] = &memory->people[i];
    }
    qsort(people, n, sizeof *people, by_name);
    for (size_t i = 1; i < n && !error; i++) {
        if (strcmp(people[i - 1]->name, people[i]->name) == 0) {
            error = iso_gallery_db_damaged(loading->db, "two people of one name", fault);
        }
        memory->same_names += iso_person_name_key_is_same(&people[i - 1]->key, &people[i]->key);
    }
    free(people);
    return error;
}

int iso_gallery_memory_load(struct iso_gallery_db *db, uint32_t algorithm,
                            const struct iso_metric *metric, bool adapt,
                            const struct iso_work_listener *listener,
                            struct iso_gallery_memory *out, struct iso_fault *fault)
{
    struct loading loading = {
        .db = db,
        .listener = listener,
        .memory = {.algorithm = algorithm, .metric = metric, .adapt = adapt},
    };
    const struct iso_gallery_visitor visitor = {load_person, load_template, load_access, &loading};
    int error = 0;
    if (metric && (iso_site_index_new(metric, adapt, &loading.memory.site) ||
                   iso_site_batch_new(loading.memory.site, algorithm, metric, &loading.batch))) {
        iso_gallery_memory_done(&loading.memory);
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    error = iso_gallery_db_load(db, &visitor, fault);
    if (!error && metric) {
        error = template_result(&loading, iso_site_batch_end(loading.batch), fault);
    }
    iso_site_batch_free(loading.batch);
    if (!error) {
        error = check_names(&loading, fault);
    }
    if (!error && metric) {
        iso_site_index_set_record(loading.memory.site, iso_gallery_db_site(db));
        error = iso_site_index_start(loading.memory.site)
                    ? iso_fault_set(fault, -ENOMEM, "gallery: no memory for a thread")
                    : 0;
    }
    if (error) {
        iso_gallery_memory_done(&loading.memory);
        return error;
    }
    *out = loading.memory;
    return 0;
}
