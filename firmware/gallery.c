#include "firmware/gallery.h"

#include <errno.h>
#include <sodium.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/gallery_db.h"

struct iso_gallery {
    struct iso_gallery_db *db;
    size_t capacity;
    uint32_t algorithm;

    struct iso_person *people; /* by rising id */
    size_t n_people, people_capacity;
    struct iso_search_entry *entries; /* in the order of people */
    size_t n_entries, entries_capacity;
};

/* ---- memory ---- */

static void free_template(const struct iso_template *tmpl)
{
    struct iso_template *own = (struct iso_template *)(uintptr_t)tmpl;
    if (own) {
        iso_template_wipe(own);
        free(own);
    }
}

/* Room for one more item of an array. */
static int reserve(void **items, size_t item_size, size_t n, size_t *capacity)
{
    if (n < *capacity) {
        return 0;
    }
    const size_t more = *capacity ? 2 * *capacity : 16;
    void *grown = reallocarray(*items, more, item_size);
    if (!grown) {
        return -ENOMEM;
    }
    *items = grown;
    *capacity = more;
    return 0;
}

static int reserve_person(struct iso_gallery *gallery)
{
    void *people = gallery->people;
    const int error = reserve(&people, sizeof *gallery->people, gallery->n_people,
                              &gallery->people_capacity);
    gallery->people = people;
    return error;
}

static int reserve_entry(struct iso_gallery *gallery)
{
    void *entries = gallery->entries;
    const int error = reserve(&entries, sizeof *gallery->entries, gallery->n_entries,
                              &gallery->entries_capacity);
    gallery->entries = entries;
    return error;
}

/* Behind the last entry of this person or of one enrolled before. There is room. */
static void insert_entry(struct iso_gallery *gallery, int64_t person,
                         const struct iso_template *tmpl)
{
    size_t at = gallery->n_entries;
    while (at > 0 && gallery->entries[at - 1].person > person) {
        at--;
    }
    memmove(gallery->entries + at + 1, gallery->entries + at,
            (gallery->n_entries - at) * sizeof *gallery->entries);
    gallery->entries[at] = (struct iso_search_entry){.person = person, .tmpl = tmpl};
    gallery->n_entries++;
}

static void remove_entries(struct iso_gallery *gallery, int64_t person)
{
    size_t kept = 0;
    for (size_t i = 0; i < gallery->n_entries; i++) {
        if (gallery->entries[i].person == person) {
            free_template(gallery->entries[i].tmpl);
        } else {
            gallery->entries[kept++] = gallery->entries[i];
        }
    }
    gallery->n_entries = kept;
}

static struct iso_person *find_own(const struct iso_gallery *gallery, int64_t id)
{
    for (size_t i = 0; i < gallery->n_people; i++) {
        if (gallery->people[i].id == id) {
            return &gallery->people[i];
        }
    }
    return NULL;
}

/* ---- opening ---- */

static int load_person(void *context, const struct iso_person *person, struct iso_fault *fault)
{
    struct iso_gallery *gallery = context;
    if (iso_gallery_find(gallery, person->name)) {
        return iso_gallery_db_damaged(gallery->db, "two people of one name", fault);
    }
    if (reserve_person(gallery)) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    gallery->people[gallery->n_people++] = *person;
    return 0;
}

/* Takes a template in that the running algorithm can use. */
static int load_usable(struct iso_gallery *gallery, struct iso_person *person,
                       const struct iso_template *tmpl, struct iso_fault *fault)
{
    struct iso_template *copy = malloc(sizeof *copy);
    if (!copy || reserve_entry(gallery)) {
        free(copy);
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    *copy = *tmpl;
    insert_entry(gallery, person->id, copy);
    person->usable++; /* NOLINT(clang-analyzer-unix.Malloc): the gallery's entry keeps the copy */
    return 0;
}

static int load_template(void *context, int64_t person_id, uint32_t algorithm, const void *bytes,
                         size_t size, struct iso_fault *fault)
{
    struct iso_gallery *gallery = context;
    struct iso_person *person = find_own(gallery, person_id);
    struct iso_template tmpl;
    if (!person) {
        return iso_gallery_db_damaged(gallery->db, "a template belongs to nobody", fault);
    }
    person->templates++;
    int error = iso_template_parse(bytes, size, &tmpl);
    if (error == -EPROTONOSUPPORT) {
        return 0;
    }
    if (error || tmpl.algorithm != algorithm) {
        return iso_gallery_db_damaged(gallery->db, "a template cannot be read", fault);
    }
    if (algorithm == gallery->algorithm) {
        error = load_usable(gallery, person, &tmpl, fault);
    }
    iso_template_wipe(&tmpl);
    return error;
}

static int load(struct iso_gallery *gallery, struct iso_fault *fault)
{
    const struct iso_gallery_visitor visitor = {load_person, load_template, gallery};
    return iso_gallery_db_load(gallery->db, &visitor, fault);
}

/* Frees people and templates, not the database. */
static void forget(struct iso_gallery *gallery)
{
    for (size_t i = 0; i < gallery->n_entries; i++) {
        free_template(gallery->entries[i].tmpl);
    }
    free(gallery->entries);
    sodium_memzero(gallery->people, gallery->n_people * sizeof *gallery->people);
    free(gallery->people);
}

int iso_gallery_open(const struct iso_gallery_options *options, struct iso_gallery **out,
                     struct iso_fault *fault)
{
    struct iso_gallery *gallery = calloc(1, sizeof *gallery);
    if (!gallery) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", options->path);
    }
    gallery->capacity = (size_t)options->capacity;
    gallery->algorithm = options->algorithm;
    int error = iso_gallery_db_open(options, &gallery->db, fault);
    error = error ? error : load(gallery, fault);
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
        forget(gallery);
        iso_gallery_db_close(gallery->db);
        free(gallery);
    }
}

/* ---- changing ---- */

int iso_gallery_room(const struct iso_gallery *gallery, const char *name, struct iso_fault *fault)
{
    const struct iso_person *person = iso_gallery_find(gallery, name);
    if (!person && gallery->n_people >= gallery->capacity) {
        return iso_fault_set(fault, -EDQUOT, "the gallery is full: %zu people", gallery->n_people);
    }
    if (person && person->templates >= ISO_GALLERY_TEMPLATES_MAX) {
        return iso_fault_set(fault, -EDQUOT, "%s has %u templates, there is no room for more", name,
                             person->templates);
    }
    return 0;
}

/* The transaction, and then the memory for which there is room: nothing can go wrong between. */
static int add_reserved(struct iso_gallery *gallery, const struct iso_person *person,
                        const struct iso_template *copy, const void *bytes, size_t size,
                        struct iso_fault *fault)
{
    const struct iso_person *known = iso_gallery_find(gallery, person->name);
    struct iso_person row = *person;
    row.id = known ? known->id : 0;
    if (known) {
        row.enrolled_s = known->enrolled_s;
    }
    int error = iso_gallery_db_begin(gallery->db, fault);
    if (error) {
        return error;
    }
    error = iso_gallery_db_put_person(gallery->db, &row, &row.id, fault);
    if (!error) {
        error = iso_gallery_db_put_template(gallery->db, row.id, copy->algorithm, bytes, size,
                                            fault);
    }
    error = iso_gallery_db_end(gallery->db, error, fault);
    if (error) {
        return error;
    }
    if (!known) {
        row.templates = row.usable = 0;
        gallery->people[gallery->n_people++] = row;
    }
    struct iso_person *own = find_own(gallery, row.id);
    own->valid_from_s = row.valid_from_s;
    own->valid_until_s = row.valid_until_s;
    own->templates++;
    own->usable++;
    insert_entry(gallery, row.id, copy);
    return 0;
}

static int check_addition(const struct iso_gallery *gallery, const struct iso_person *person,
                          const struct iso_template *tmpl, struct iso_fault *fault)
{
    const char *flaw = iso_person_name_flaw(person->name);
    if (flaw) {
        return iso_fault_set(fault, -EINVAL, "%s", flaw);
    }
    if (tmpl->algorithm != gallery->algorithm) {
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
    struct iso_template *copy = malloc(sizeof *copy);
    if (!copy || reserve_person(gallery) || reserve_entry(gallery)) {
        error = iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    } else {
        /* As it will be read back: the search sees the same before and after a restart. */
        error = iso_template_parse(bytes, (size_t)size, copy);
    }
    if (!error) {
        error = add_reserved(gallery, person, copy, bytes, (size_t)size, fault);
    }
    if (error) {
        free_template(copy);
    }
    /* NOLINTNEXTLINE(clang-analyzer-unix.Malloc): the gallery's entry keeps the copy */
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
    remove_entries(gallery, person->id);
    const size_t at = (size_t)(person - gallery->people);
    gallery->n_people--;
    memmove(gallery->people + at, gallery->people + at + 1,
            (gallery->n_people - at) * sizeof *gallery->people);
    return 0;
}

/* ---- copying between galleries ---- */

static int check_item(const struct iso_gallery_item *item, struct iso_fault *fault)
{
    const char *flaw = iso_person_name_flaw(item->person.name);
    if (flaw) {
        return iso_fault_set(fault, -EINVAL, "%s", flaw);
    }
    if (item->n < 1 || item->n > ISO_GALLERY_TEMPLATES_MAX) {
        return iso_fault_set(fault, -EINVAL, "%s has %zu templates", item->person.name, item->n);
    }
    for (size_t i = 0; i < item->n; i++) {
        struct iso_template tmpl = {.algorithm = item->templates[i].algorithm};
        const int error = iso_template_parse(item->templates[i].bytes, item->templates[i].size,
                                             &tmpl);
        const bool fits = tmpl.algorithm == item->templates[i].algorithm;
        iso_template_wipe(&tmpl);
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

/* Within a transaction. */
static int put_items(struct iso_gallery *gallery, const struct iso_gallery_item *items, size_t n,
                     bool replace, size_t *added, struct iso_fault *fault)
{
    int error = 0;
    for (size_t i = 0; !error && i < n; i++) {
        const struct iso_person *known = iso_gallery_find(gallery, items[i].person.name);
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
static int reread(const struct iso_gallery *gallery, struct iso_gallery *out,
                  struct iso_fault *fault)
{
    *out = (struct iso_gallery){
        .db = gallery->db, .capacity = gallery->capacity, .algorithm = gallery->algorithm};
    int error = load(out, fault);
    if (!error && out->n_people > out->capacity) {
        error = iso_fault_set(fault, -EDQUOT, "the gallery is full: it holds %zu people, not %zu",
                              out->capacity, out->n_people);
    }
    return error;
}

static int check_items(const struct iso_gallery_item *items, size_t n, struct iso_fault *fault)
{
    for (size_t i = 0; i < n; i++) {
        const int error = check_item(&items[i], fault);
        if (error) {
            return error;
        }
        for (size_t j = 0; j < i; j++) {
            if (strcmp(items[i].person.name, items[j].person.name) == 0) {
                return iso_fault_set(fault, -EINVAL, "%s comes twice", items[i].person.name);
            }
        }
    }
    return 0;
}

int iso_gallery_import(struct iso_gallery *gallery, const struct iso_gallery_item *items, size_t n,
                       bool replace, size_t *added, struct iso_fault *fault)
{
    struct iso_gallery now = {0};
    size_t count = 0;
    int error = check_items(items, n, fault);
    error = error ? error : iso_gallery_db_begin(gallery->db, fault);
    if (error) {
        return error;
    }
    error = put_items(gallery, items, n, replace, &count, fault);
    error = error ? error : reread(gallery, &now, fault);
    error = iso_gallery_db_end(gallery->db, error, fault);
    if (error) {
        forget(&now);
        return error;
    }
    forget(gallery);
    *gallery = now;
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
    const struct iso_person *person = find_own(exporting->gallery, person_id);
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

int iso_gallery_rotate(struct iso_gallery *gallery, struct iso_fault *fault)
{
    return iso_gallery_db_rotate(gallery->db, fault);
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
    *n = gallery->n_people;
    return gallery->people;
}

const struct iso_person *iso_gallery_find(const struct iso_gallery *gallery, const char *name)
{
    for (size_t i = 0; i < gallery->n_people; i++) {
        if (strcmp(gallery->people[i].name, name) == 0) {
            return &gallery->people[i];
        }
    }
    return NULL;
}

const struct iso_person *iso_gallery_find_id(const struct iso_gallery *gallery, int64_t id)
{
    return find_own(gallery, id);
}

const struct iso_search_entry *iso_gallery_entries(const struct iso_gallery *gallery, int *n)
{
    *n = (int)gallery->n_entries;
    return gallery->entries;
}

const struct iso_search_entry *iso_gallery_entries_of(const struct iso_gallery *gallery,
                                                      int64_t person, int *n)
{
    size_t first = 0, end;
    while (first < gallery->n_entries && gallery->entries[first].person != person) {
        first++;
    }
    end = first;
    while (end < gallery->n_entries && gallery->entries[end].person == person) {
        end++;
    }
    *n = (int)(end - first);
    return *n ? gallery->entries + first : NULL;
}
