#include "firmware/gallery/gallery.h"

#include <errno.h>
#include <sodium.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/terminal/words.h"
#include "firmware/gallery/gallery_state.h"

/* ---- opening ---- */

int iso_gallery_open(const struct iso_gallery_options *options, struct iso_gallery **out,
                     struct iso_fault *fault)
{
    struct iso_gallery *gallery = calloc(1, sizeof *gallery);
    if (!gallery) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", options->path);
    }
    gallery->capacity = (size_t)options->capacity;
    int error = iso_gallery_db_open(options, &gallery->db, fault);
    if (!error) {
        error = iso_gallery_memory_load(gallery->db, options->algorithm, options->metric, NULL,
                                        &gallery->memory, fault);
    }
    if (error) {
        iso_gallery_close(gallery);
        return error;
    }
    *out = gallery;
    return 0;
}

void iso_gallery_close(struct iso_gallery *gallery)
{
    if (gallery) {
        iso_gallery_memory_done(&gallery->memory);
        iso_gallery_db_close(gallery->db);
        free(gallery);
    }
}

/* ---- changing ---- */

int iso_gallery_room(const struct iso_gallery *gallery, const char *name, struct iso_fault *fault)
{
    const struct iso_person *person = iso_gallery_find(gallery, name);
    if (!person && gallery->memory.n_people >= gallery->capacity) {
        return iso_fault_set_code(fault, ISO_FAULT_GALLERY_FULL, -EDQUOT,
                                  "the gallery is full: %zu %s", gallery->memory.n_people,
                                  iso_plural(gallery->memory.n_people, "person", "people"));
    }
    if (person && person->templates >= ISO_GALLERY_TEMPLATES_MAX) {
        return iso_fault_set_code(fault, ISO_FAULT_GALLERY_FULL, -EDQUOT,
                                  "%s has %u templates, the most that one person can have",
                                  person->name, person->templates);
    }
    return 0;
}

/* The transaction, and then the memory, where nothing can go wrong. */
static int add_prepared(struct iso_gallery *gallery, const struct iso_person *person,
                        const void *bytes, size_t size, struct iso_gallery_kept *kept,
                        struct iso_fault *fault)
{
    const struct iso_person *known = iso_gallery_find(gallery, person->name);
    struct iso_person row = *person;
    row.id = known ? known->id : 0;
    if (iso_person_name_key(row.name, &row.key)) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    if (known) {
        row.enrolled_s = known->enrolled_s;
        row.key = known->key;
        memcpy(row.name, known->name, sizeof row.name);
    }
    int error = iso_gallery_db_begin(gallery->db, fault);
    if (error) {
        return error;
    }
    error = iso_gallery_db_put_person(gallery->db, &row, &row.id, fault);
    if (!error) {
        error = iso_gallery_db_put_template(gallery->db, row.id, gallery->memory.algorithm, bytes,
                                            size, fault);
    }
    error = iso_gallery_db_end(gallery->db, error, fault);
    if (!error) {
        iso_gallery_memory_add(&gallery->memory, &row, kept);
    }
    return error;
}

static int check_addition(const struct iso_gallery *gallery, const struct iso_person *person,
                          const struct iso_template *tmpl, struct iso_fault *fault)
{
    const char *flaw = iso_gallery_find(gallery, person->name) ? NULL
                                                               : iso_person_name_flaw(person->name);
    if (flaw) { /* of a new name: those of before stay */
        return iso_fault_set(fault, -EINVAL, "%s", flaw);
    }
    if (tmpl->algorithm != gallery->memory.algorithm) {
        return iso_fault_set(fault, -EINVAL, "the template is of another algorithm");
    }
    return iso_gallery_room(gallery, person->name, fault);
}

int iso_gallery_add(struct iso_gallery *gallery, const struct iso_person *person,
                    const struct iso_template *tmpl, struct iso_fault *fault)
{
    uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    int error = check_addition(gallery, person, tmpl, fault);
    if (error) {
        return error;
    }
    const int size = iso_template_serialise(tmpl, bytes, sizeof bytes);
    if (size < 0) {
        return iso_fault_set(fault, -EINVAL, "the template is out of range");
    }
    /* As it will be read back: the search sees the same before and after a restart. */
    struct iso_gallery_kept kept = {.tmpl = NULL};
    error = iso_gallery_memory_prepare(&gallery->memory, bytes, (size_t)size, &kept);
    if (error) {
        error = iso_fault_set(fault, error == -ENOMEM ? error : -EINVAL, "%s",
                              error == -ENOMEM ? "gallery: out of memory"
                                               : "the template is out of range");
    } else {
        error = add_prepared(gallery, person, bytes, (size_t)size, &kept, fault);
    }
    iso_gallery_memory_discard(&kept);
    sodium_memzero(bytes, sizeof bytes);
    return error;
}

int iso_gallery_remove(struct iso_gallery *gallery, const char *name, struct iso_fault *fault)
{
    const struct iso_person *person = iso_gallery_find(gallery, name);
    if (!person) {
        return iso_fault_set(fault, -ENOENT, "%s: no such person", name);
    }
    int error = iso_gallery_db_begin(gallery->db, fault);
    if (error) {
        return error;
    }
    error = iso_gallery_db_drop_person(gallery->db, person->id, fault);
    error = iso_gallery_db_end(gallery->db, error, fault);
    if (error) {
        return error;
    }
    iso_gallery_memory_remove(&gallery->memory, person->id);
    return 0;
}

/* ---- copying between galleries ---- */

/* A person who is here under just this name keeps it. */
static bool has_exactly(const struct iso_gallery *gallery, const char *name)
{
    const struct iso_person *person = iso_gallery_find(gallery, name);
    return person && strcmp(person->name, name) == 0;
}

static int check_item(const struct iso_gallery *gallery, const struct iso_gallery_item *item,
                      struct iso_fault *fault)
{
    const char *flaw = iso_person_name_flaw(item->person.name);
    if (flaw && !has_exactly(gallery, item->person.name)) {
        return iso_fault_set(fault, -EINVAL, "%s", flaw);
    }
    if (item->n < 1 || item->n > ISO_GALLERY_TEMPLATES_MAX) {
        return iso_fault_set(fault, -EINVAL, "%s has %zu templates", item->person.name, item->n);
    }
    for (size_t i = 0; i < item->n; i++) {
        struct iso_template_facts facts = {.algorithm = item->templates[i].algorithm};
        const int error = iso_template_check(item->templates[i].bytes, item->templates[i].size,
                                             &facts);
        const bool fits = facts.algorithm == item->templates[i].algorithm;
        if ((error && error != -EPROTONOSUPPORT) || (!error && !fits)) {
            return iso_fault_set(fault, -EINVAL, "a template of %s cannot be read",
                                 item->person.name);
        }
    }
    return 0;
}

static int put_item(struct iso_gallery *gallery, const struct iso_gallery_item *item,
                    struct iso_fault *fault)
{
    struct iso_person row = item->person;
    row.id = 0;
    int error = iso_gallery_db_put_person(gallery->db, &row, &row.id, fault);
    for (size_t i = 0; !error && i < item->n; i++) {
        error = iso_gallery_db_put_template(gallery->db, row.id, item->templates[i].algorithm,
                                            item->templates[i].bytes, item->templates[i].size,
                                            fault);
    }
    return error;
}

/* An import of n people: first they are put in, then everybody is read back. */
struct importing {
    const struct iso_work_listener *listener;
    size_t n;
};

static void tell_reread(void *context, uint64_t done, uint64_t total)
{
    const struct importing *importing = context;
    iso_work_step(importing->listener, importing->n + done, importing->n + total);
}

/* Within a transaction. */
static int put_items(struct iso_gallery *gallery, const struct iso_gallery_item *items, size_t n,
                     bool replace, const struct iso_work_listener *listener, size_t *added,
                     struct iso_fault *fault)
{
    const size_t most = n + gallery->memory.n_people + n; /* if nobody is known */
    int error = 0;
    for (size_t i = 0; !error && i < n; i++) {
        const struct iso_person *known = iso_gallery_find(gallery, items[i].person.name);
        iso_work_step(listener, i, most);
        if (known && !replace) {
            continue;
        }
        if (known) {
            error = iso_gallery_db_drop_person(gallery->db, known->id, fault);
        }
        error = error ? error : put_item(gallery, &items[i], fault);
        *added += error ? 0 : 1;
    }
    return error;
}

/* What the database holds now, read back before the transaction ends. Two of one name are found
 * here, when they have come with one import. */
static int reread(const struct iso_gallery *gallery, struct importing *importing,
                  struct iso_gallery_memory *out, struct iso_fault *fault)
{
    const struct iso_work_listener listener = {tell_reread, importing};
    const int error = iso_gallery_memory_load(gallery->db, gallery->memory.algorithm,
                                              gallery->memory.metric, &listener, out, fault);
    return !error && out->n_people > gallery->capacity
               ? iso_fault_set_code(fault, ISO_FAULT_GALLERY_FULL, -EDQUOT,
                                    "the gallery is full: it holds %zu people, not %zu",
                                    gallery->capacity, out->n_people)
               : error;
}

static int check_items(const struct iso_gallery *gallery, const struct iso_gallery_item *items,
                       size_t n, struct iso_fault *fault)
{
    for (size_t i = 0; i < n; i++) {
        const int error = check_item(gallery, &items[i], fault);
        if (error) {
            return error;
        }
    }
    return iso__gallery_check_names(gallery, items, n, fault);
}

int iso_gallery_import(struct iso_gallery *gallery, const struct iso_gallery_item *items, size_t n,
                       bool replace, const struct iso_work_listener *listener, size_t *added,
                       struct iso_fault *fault)
{
    struct importing importing = {listener, n};
    struct iso_gallery_memory now = {0};
    size_t count = 0;
    int error = check_items(gallery, items, n, fault);
    error = error ? error : iso_gallery_db_begin(gallery->db, fault);
    if (error) {
        return error;
    }
    error = put_items(gallery, items, n, replace, listener, &count, fault);
    error = error ? error : reread(gallery, &importing, &now, fault);
    error = iso_gallery_db_end(gallery->db, error, fault);
    if (error) {
        iso_gallery_memory_done(&now);
        return error;
    }
    iso_gallery_memory_done(&gallery->memory);
    gallery->memory = now;
    *added = count;
    return 0;
}

/* Gathers the templates of one person, and hands them on when the next one's begin. */
struct exporting {
    const struct iso_gallery *gallery;
    const struct iso_person *only; /* NULL: all */
    struct iso_gallery_item item;
    uint8_t bytes[ISO_GALLERY_TEMPLATES_MAX][ISO_TEMPLATE_BYTES_MAX];
    int (*each)(void *context, const struct iso_gallery_item *item, struct iso_fault *fault);
    void *context;
};

static int hand_on(struct exporting *exporting, struct iso_fault *fault)
{
    const int error = exporting->item.n > 0
                          ? exporting->each(exporting->context, &exporting->item, fault)
                          : 0;
    exporting->item.n = 0;
    return error;
}

static int export_person(void *context, const struct iso_person *person, struct iso_fault *fault)
{
    (void)context, (void)person, (void)fault; /* known from memory */
    return 0;
}

static int export_template(void *context, int64_t person_id, uint32_t algorithm, const void *bytes,
                           size_t size, struct iso_fault *fault)
{
    struct exporting *exporting = context;
    struct iso_gallery_item *item = &exporting->item;
    const struct iso_person *person = iso_gallery_memory_find(&exporting->gallery->memory,
                                                              person_id);
    if (!person || (exporting->only && exporting->only != person)) {
        return 0;
    }
    if (item->n > 0 && item->person.id != person_id) {
        const int error = hand_on(exporting, fault);
        if (error) {
            return error;
        }
    }
    if (item->n == ISO_GALLERY_TEMPLATES_MAX || size > sizeof exporting->bytes[0]) {
        return iso_gallery_db_damaged(exporting->gallery->db, "too many templates", fault);
    }
    item->person = *person;
    memcpy(exporting->bytes[item->n], bytes, size);
    item->templates[item->n].algorithm = algorithm;
    item->templates[item->n].bytes = exporting->bytes[item->n];
    item->templates[item->n].size = size;
    item->n++;
    return 0;
}

int iso_gallery_export(struct iso_gallery *gallery, const char *name,
                       int (*each)(void *context, const struct iso_gallery_item *item,
                                   struct iso_fault *fault),
                       void *context, struct iso_fault *fault)
{
    const struct iso_person *only = name ? iso_gallery_find(gallery, name) : NULL;
    if (name && !only) {
        return iso_fault_set(fault, -ENOENT, "%s: no such person", name);
    }
    struct exporting *exporting = calloc(1, sizeof *exporting);
    if (!exporting) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    exporting->gallery = gallery;
    exporting->only = only;
    exporting->each = each;
    exporting->context = context;
    const struct iso_gallery_visitor visitor = {export_person, export_template, exporting};
    int error = iso_gallery_db_load(gallery->db, &visitor, fault);
    error = error ? error : hand_on(exporting, fault);
    sodium_memzero(exporting, sizeof *exporting);
    free(exporting);
    return error;
}

/* ---- keys ---- */

int iso_gallery_rotate(struct iso_gallery *gallery, const struct iso_work_listener *listener,
                       struct iso_fault *fault)
{
    return iso_gallery_db_rotate(gallery->db, listener, fault);
}

int iso_gallery_renew(struct iso_gallery *gallery, struct iso_fault *fault)
{
    const int error = iso_gallery_db_begin(gallery->db, fault);
    return error ? error : iso_gallery_db_end(gallery->db, 0, fault);
}

int iso_gallery_renew_anchor(struct iso_gallery *gallery, struct iso_fault *fault)
{
    return iso_gallery_db_renew_anchor(gallery->db, fault);
}

struct iso_gallery_version iso_gallery_version(const struct iso_gallery *gallery)
{
    return iso_gallery_db_version(gallery->db);
}

/* ---- looking ---- */

const struct iso_person *iso_gallery_people(const struct iso_gallery *gallery, size_t *n)
{
    *n = iso__gallery_is_lost(gallery) ? 0 : gallery->memory.n_people;
    return gallery->memory.people;
}

const struct iso_person *iso_gallery_find(const struct iso_gallery *gallery, const char *name)
{
    const struct iso_gallery_memory *memory = &gallery->memory;
    const struct iso_person *same = NULL;
    struct iso_person_name_key key;
    const bool has_key = iso_person_name_key(name, &key) == 0;
    for (size_t i = 0; i < memory->n_people && !iso__gallery_is_lost(gallery); i++) {
        const struct iso_person *person = &memory->people[i];
        if (strcmp(person->name, name) == 0) {
            return person;
        }
        if (has_key && !same && iso_person_name_key_is_same(&person->key, &key)) {
            same = person;
        }
    }
    return same;
}

size_t iso_gallery_same_names(const struct iso_gallery *gallery)
{
    return gallery->memory.same_names;
}

const struct iso_person *iso_gallery_find_id(const struct iso_gallery *gallery, int64_t id)
{
    return iso__gallery_is_lost(gallery) ? NULL : iso_gallery_memory_find(&gallery->memory, id);
}

static int open_templates(void *owner, int64_t person, struct iso_template *out, int capacity,
                          int *n, struct iso_fault *fault)
{
    return iso_gallery_templates(owner, person, out, capacity, n, fault);
}

struct iso_candidate_list iso_gallery_everybody(struct iso_gallery *gallery)
{
    if (iso__gallery_is_lost(gallery)) {
        return (struct iso_candidate_list){0};
    }
    return (struct iso_candidate_list){
        .entries = gallery->memory.entries,
        .n_entries = (int)gallery->memory.n_entries,
        .index = gallery->memory.index,
        .templates = open_templates,
        .owner = gallery,
        .version = iso_gallery_version(gallery).changes,
    };
}

struct iso_candidate_list iso_gallery_only(struct iso_gallery *gallery, int64_t person)
{
    const struct iso_gallery_memory *memory = &gallery->memory;
    struct iso_metric_vector vector;
    if (iso__gallery_is_lost(gallery)) {
        return (struct iso_candidate_list){0};
    }
    if (memory->index) {
        const int error = iso_index_find(memory->index, person, &vector);
        sodium_memzero(&vector, sizeof vector);
        struct iso_candidate_list own = iso_gallery_everybody(gallery);
        own.person = person;
        return error ? (struct iso_candidate_list){0} : own;
    }
    size_t first = 0, end;
    while (first < memory->n_entries && memory->entries[first].person != person) {
        first++;
    }
    end = first;
    while (end < memory->n_entries && memory->entries[end].person == person) {
        end++;
    }
    return first == end ? (struct iso_candidate_list){0}
                        : (struct iso_candidate_list){.entries = memory->entries + first,
                                                      .n_entries = (int)(end - first)};
}

struct fetching {
    const struct iso_gallery *gallery;
    struct iso_template *out;
    int n, capacity;
    uint32_t seen;
};

static int fetch_template(void *context, int64_t person_id, uint32_t algorithm, const void *bytes,
                          size_t size, struct iso_fault *fault)
{
    struct fetching *fetching = context;
    (void)person_id;
    fetching->seen++;
    if (algorithm != fetching->gallery->memory.algorithm || fetching->n == fetching->capacity) {
        return 0;
    }
    const int error = iso_template_parse(bytes, size, &fetching->out[fetching->n]);
    fetching->n += !error;
    return error && error != -EPROTONOSUPPORT
               ? iso_gallery_db_damaged(fetching->gallery->db, "a template cannot be read", fault)
               : 0;
}

int iso_gallery_templates(struct iso_gallery *gallery, int64_t person, struct iso_template *out,
                          int capacity, int *n, struct iso_fault *fault)
{
    const struct iso_person *own = iso_gallery_find_id(gallery, person);
    struct fetching fetching = {gallery, out, 0, capacity, 0};
    const struct iso_gallery_visitor visitor = {NULL, fetch_template, &fetching};
    if (!own) {
        return iso_fault_set(fault, -ENOENT, "nobody has the number %lld", (long long)person);
    }
    int error = iso_gallery_db_templates(gallery->db, person, &visitor, fault);
    if (!error && fetching.seen != own->templates) {
        error = iso_gallery_db_damaged(gallery->db, "records are missing", fault);
    }
    if (error) {
        sodium_memzero(out, (size_t)fetching.n * sizeof *out);
        return error;
    }
    *n = fetching.n;
    return 0;
}
