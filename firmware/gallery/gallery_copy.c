/* Copies people between galleries, with their templates as they are stored. */
#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/gallery/gallery_seal.h"
#include "firmware/gallery/gallery_state.h"

/* ---- the names in an import ---- */

/* Whether a person in this gallery has exactly this name. Such a name may stay, even if it would be
 * refused today. */
static bool has_exactly(const struct iso_gallery *gallery, const char *name)
{
    const struct iso_person *person = iso_gallery_find(gallery, name);
    return person && strcmp(person->name, name) == 0;
}

/* A name in the import, with its key. */
struct coming {
    const char *name;
    struct iso_person_name_key key;
};

static int by_key(const void *a, const void *b)
{
    const struct coming *one = a, *other = b;
    const int order = memcmp(&one->key, &other->key, sizeof one->key);
    return order ? order : strcmp(one->name, other->name);
}

/* An import may contain two spellings of one name only if this gallery has two people with exactly
 * these names, as an old gallery may. */
static int check_pair(const struct iso_gallery *gallery, const struct coming *one,
                      const struct coming *other, struct iso_fault *fault)
{
    if (!iso_person_name_key_is_same(&one->key, &other->key)) {
        return 0;
    }
    if (strcmp(one->name, other->name) == 0) {
        return iso_fault_set(fault, -EINVAL, "%s comes twice", one->name);
    }
    return has_exactly(gallery, one->name) && has_exactly(gallery, other->name)
               ? 0
               : iso_fault_set(fault, -EINVAL, "%.80s and %.80s are one name: rename one of them",
                               one->name, other->name);
}

/* Checks that all names are different, also without regard to case (gallery.h). Returns 0, -EINVAL
 * or -ENOMEM. */
static int check_names(const struct iso_gallery *gallery, const struct iso_gallery_item *items,
                       size_t n, struct iso_fault *fault)
{
    int error = 0;
    struct coming *coming = calloc(n ? n : 1, sizeof *coming);
    for (size_t i = 0; coming && !error && i < n; i++) {
        coming[i].name = items[i].person.name;
        error = iso_person_name_key(coming[i].name, &coming[i].key);
    }
    if (!coming || error) {
        free(coming);
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    qsort(coming, n, sizeof *coming, by_key);
    for (size_t i = 1; !error && i < n; i++) {
        error = check_pair(gallery, &coming[i - 1], &coming[i], fault);
    }
    free(coming);
    return error;
}

/* ---- import ---- */

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

/* `earlier` is the id of the person whom this one replaces, and whose access record stays; 0:
 * none. */
static int put_item(struct iso_gallery *gallery, const struct iso_gallery_item *item,
                    int64_t earlier, struct iso_fault *fault)
{
    const struct iso_gallery_access *access = earlier ? iso_gallery_access_find(
                                                            &gallery->memory.access, earlier)
                                                      : NULL;
    struct iso_person row = item->person;
    row.id = 0;
    int64_t number = 0;
    int error = iso_gallery_db_put_person(gallery->db, &row, &row.id, fault);
    for (size_t i = 0; !error && i < item->n; i++) {
        error = iso__gallery_put_template(gallery, row.id, item, i, &number, fault);
    }
    if (!error && access) {
        error = iso_gallery_db_put_access(gallery->db, row.id, access->bytes, access->size, fault);
    }
    return error;
}

/* An import of n people. First they are stored, and then the whole gallery is read back. */
struct importing {
    const struct iso_work_listener *listener;
    size_t n;
};

static void tell_reread(void *context, uint64_t done, uint64_t total)
{
    const struct importing *importing = context;
    iso_work_step(importing->listener, importing->n + done, importing->n + total);
}

/* Called within a transaction. */
static int put_items(struct iso_gallery *gallery, const struct iso_gallery_item *items, size_t n,
                     const struct iso_work_listener *listener, struct iso_fault *fault)
{
    /* It is smaller by each person who is replaced; the number is not known yet. */
    const size_t most = n + gallery->memory.n_people + n;
    int error = 0;
    for (size_t i = 0; !error && i < n; i++) {
        const struct iso_person *known = iso_gallery_find(gallery, items[i].person.name);
        iso_work_step(listener, i, most);
        if (known) {
            error = iso_gallery_db_drop_person(gallery->db, known->id, fault);
        }
        if (!error) {
            error = put_item(gallery, &items[i], known ? known->id : 0, fault);
        }
    }
    return error;
}

/* Reads the database back before the transaction ends. This also detects two people with one name
 * in an import. */
static int reread_people(const struct iso_gallery *gallery, struct importing *importing,
                         struct iso_gallery_memory *out, struct iso_fault *fault)
{
    const struct iso_work_listener listener = {tell_reread, importing};
    const int error = iso_gallery_memory_load(gallery->db, gallery->memory.algorithm,
                                              gallery->memory.metric, gallery->memory.adapt,
                                              &listener, out, fault);
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
    return check_names(gallery, items, n, fault);
}

/* An import counts as an enrolment. If it only gives new numbers to people of this gallery, the
 * marks of earlier enrolments are dropped: marks refer to the order of numbers. */
static void mark_import(struct iso_gallery *gallery)
{
    if (gallery->renumbers) {
        iso_gallery_db_site(gallery->db)->n_marks = 0;
    } else {
        iso_gallery_db_mark(gallery->db);
    }
}

/* Imports some people who are here already, who get new numbers, and perhaps others. */
static int import_over(struct iso_gallery *gallery, const struct iso_gallery_item *items, size_t n,
                       const struct iso_work_listener *listener, size_t *added,
                       struct iso_fault *fault)
{
    struct importing importing = {listener, n};
    struct iso_gallery_memory now = {0};
    int error = iso_gallery_db_begin(gallery->db, fault);
    if (error) {
        return error;
    }
    mark_import(gallery);
    error = put_items(gallery, items, n, listener, fault);
    if (!error) {
        error = reread_people(gallery, &importing, &now, fault);
    }
    error = iso_gallery_db_end(gallery->db, error, fault);
    if (error) {
        iso_gallery_memory_done(&now);
        return error;
    }
    iso_gallery_memory_set_sensor(&now, gallery->memory.sensor);
    iso_gallery_memory_done(&gallery->memory);
    gallery->memory = now;
    *added = n;
    return 0;
}

/* Imports the people who are not here yet. */
static int import_new(struct iso_gallery *gallery, const struct iso_gallery_item *items, size_t n,
                      const struct iso_work_listener *listener, size_t *added,
                      struct iso_fault *fault)
{
    struct iso_gallery_change *changes = calloc(n ? n : 1, sizeof *changes);
    if (!changes) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    size_t n_new = 0;
    for (size_t i = 0; i < n; i++) {
        if (!iso_gallery_find(gallery, items[i].person.name)) {
            changes[n_new++].item = items[i];
        }
    }
    const int error = iso__gallery_apply(gallery, changes, n_new, listener, fault);
    *added = error ? *added : n_new;
    sodium_memzero(changes, n * sizeof *changes);
    free(changes);
    return error;
}

static bool knows_one(const struct iso_gallery *gallery, const struct iso_gallery_item *items,
                      size_t n)
{
    bool known = false;
    for (size_t i = 0; i < n && !known; i++) {
        known = iso_gallery_find(gallery, items[i].person.name) != NULL;
    }
    return known;
}

int iso_gallery_import(struct iso_gallery *gallery, const struct iso_gallery_item *items, size_t n,
                       bool replace, const struct iso_work_listener *listener, size_t *added,
                       struct iso_fault *fault)
{
    const int error = check_items(gallery, items, n, fault);
    if (error) {
        return error;
    }
    return replace && knows_one(gallery, items, n)
               ? import_over(gallery, items, n, listener, added, fault)
               : import_new(gallery, items, n, listener, added, fault);
}

/* ---- export ---- */

/* Collects the templates of one person, and passes them on when the templates of the next person
 * begin. */
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
    (void)context, (void)person, (void)fault; /* the people are read from memory */
    return 0;
}

static int export_access(void *context, const struct iso_gallery_place *place, const void *bytes,
                         size_t size, struct iso_fault *fault)
{
    (void)context, (void)place, (void)bytes, (void)size, (void)fault; /* stays at this door */
    return 0;
}

static int export_template(void *context, const struct iso_gallery_place *place, const void *bytes,
                           size_t size, struct iso_fault *fault)
{
    struct exporting *exporting = context;
    struct iso_gallery_item *item = &exporting->item;
    const struct iso_person *person = iso_gallery_memory_find(&exporting->gallery->memory,
                                                              place->person);
    if (!person || (exporting->only && exporting->only != person)) {
        return 0;
    }
    if (item->n > 0 && item->person.id != place->person) {
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
    item->templates[item->n].algorithm = place->algorithm;
    item->templates[item->n].bytes = exporting->bytes[item->n];
    item->templates[item->n].size = size;
    item->templates[item->n].excluded = !iso_site_record_teaches(
        iso_gallery_db_site(exporting->gallery->db), (uint64_t)place->number);
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
    const struct iso_gallery_visitor visitor = {.person = export_person,
                                                .template = export_template,
                                                .access = export_access,
                                                .context = exporting};
    int error = only ? iso_gallery_db_templates(gallery->db, only->id, &visitor, fault)
                     : iso_gallery_db_load(gallery->db, &visitor, fault);
    if (!error && only && exporting->item.n != only->templates) {
        error = iso_gallery_db_damaged(gallery->db, "records are missing", fault);
    }
    if (!error) {
        error = hand_on(exporting, fault);
    }
    sodium_memzero(exporting, sizeof *exporting);
    free(exporting);
    return error;
}
