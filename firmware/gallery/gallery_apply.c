/* The changes of a fleet and the people of an import: several people and one record in one
 * transaction, and in memory only these people are touched. */
#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/gallery/gallery_seal.h"
#include "firmware/gallery/gallery_state.h"

/* A change with everything that can fail made before the transaction. */
struct prepared {
    struct iso_person row;
    struct iso_gallery_kept *kept; /* as many as the item has templates */
    bool usable[ISO_GALLERY_TEMPLATES_MAX];
    uint32_t n_unusable;
    uint8_t *access;
};

static int no_memory(struct iso_fault *fault)
{
    return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
}

/* ---- checking ---- */

/* The changes of one call. */
struct call {
    struct iso_gallery_change *changes;
    size_t n;
    const struct iso_work_listener *listener;
};

/* Whether the same call removes this person, or gives the person another name; that the new name is
 * another one is checked later (check_names). */
static bool gives_up_name(const struct call *call, const struct iso_person *holder)
{
    for (size_t i = 0; i < call->n; i++) {
        if (call->changes[i].person == holder->id) {
            return true;
        }
    }
    return false;
}

static int check_who(const struct iso_gallery *gallery, const struct call *call,
                     const struct iso_gallery_change *change, struct iso_fault *fault)
{
    const struct iso_person *known = iso_gallery_find_id(gallery, change->person);
    if ((change->person || change->remove) && !known) {
        return iso_fault_set(fault, -ENOENT, "no such person");
    }
    if (change->remove) {
        return 0;
    }
    const char *name = change->item.person.name;
    const char *flaw = iso_person_name_flaw(name);
    const struct iso_person *holder = iso_gallery_find(gallery, name);
    if (flaw) {
        return iso_fault_set(fault, -EINVAL, "%s", flaw);
    }
    if (holder && holder != known && !gives_up_name(call, holder)) {
        return iso_fault_set(fault, -EEXIST, "somebody else is enrolled as %s", holder->name);
    }
    if (change->item.n > ISO_GALLERY_TEMPLATES_MAX ||
        (change->keep && (change->item.n || !known))) {
        return iso_fault_set(fault, -EINVAL, "%s has %zu templates", name, change->item.n);
    }
    return change->access_size > ISO_GALLERY_ACCESS_MAX
               ? iso_fault_set(fault, -EFBIG, "an access record of %zu bytes; at most %d are kept",
                               change->access_size, ISO_GALLERY_ACCESS_MAX)
               : 0;
}

/* Two changes of one call may not give one name to two people: a name that is free in the gallery
 * can be taken only once. */
static int check_names(const struct iso_gallery_change *changes, const struct prepared *prepared,
                       size_t n, struct iso_fault *fault)
{
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < i; j++) {
            if (changes[i].person && changes[i].person == changes[j].person) {
                return iso_fault_set(fault, -EINVAL, "a person is changed twice");
            }
            if (!changes[i].remove && !changes[j].remove &&
                iso_person_name_key_is_same(&prepared[i].row.key, &prepared[j].row.key)) {
                return iso_fault_set(fault, -EINVAL, "%s comes twice", prepared[i].row.name);
            }
        }
    }
    return 0;
}

/* ---- preparing ---- */

static int prepare_template(struct iso_gallery *gallery, const struct iso_gallery_change *change,
                            size_t i, struct prepared *out, struct iso_fault *fault)
{
    const uint32_t algorithm = change->item.templates[i].algorithm;
    const void *bytes = change->item.templates[i].bytes;
    const size_t size = change->item.templates[i].size;
    struct iso_template_facts facts = {.algorithm = algorithm};
    int error = iso_template_check(bytes, size, &facts);
    const bool newer = error == -EPROTONOSUPPORT;
    if (!error && facts.algorithm != algorithm) {
        error = -EINVAL;
    }
    if (!error && algorithm == gallery->memory.algorithm) {
        error = iso_gallery_memory_prepare(&gallery->memory, bytes, size, &out->kept[i]);
        out->usable[i] = !error;
    }
    out->n_unusable += !out->usable[i];
    if (error == -ENOMEM) {
        return no_memory(fault);
    }
    return error && !newer ? iso_fault_set(fault, -EINVAL, "a template of %s cannot be read",
                                           change->item.person.name)
                           : 0;
}

static int prepare(struct iso_gallery *gallery, const struct call *call,
                   const struct iso_gallery_change *change, struct prepared *out,
                   struct iso_fault *fault)
{
    int error = check_who(gallery, call, change, fault);
    if (error || change->remove) {
        return error;
    }
    out->row = change->item.person;
    out->row.id = change->keep ? change->person : 0;
    out->kept = calloc(change->item.n ? change->item.n : 1, sizeof *out->kept);
    out->access = change->access_size ? malloc(change->access_size) : NULL;
    if (!out->kept || (change->access_size && !out->access) ||
        iso_person_name_key(out->row.name, &out->row.key)) {
        return no_memory(fault);
    }
    if (change->access_size) {
        memcpy(out->access, change->access, change->access_size);
    }
    for (size_t i = 0; !error && i < change->item.n; i++) {
        error = prepare_template(gallery, change, i, out, fault);
    }
    return error;
}

static int make_room(struct iso_gallery *gallery, const struct iso_gallery_change *changes,
                     size_t n, struct iso_fault *fault)
{
    size_t templates = 0, people = gallery->memory.n_people;
    for (size_t i = 0; i < n; i++) {
        templates += changes[i].remove ? 0 : changes[i].item.n;
        people += !changes[i].remove && !changes[i].person;
        people -= changes[i].remove;
    }
    if (people > gallery->capacity && people > gallery->memory.n_people) {
        return iso_fault_set_code(fault, ISO_FAULT_GALLERY_FULL, -EDQUOT,
                                  "the gallery is full: it holds %zu people, not %zu",
                                  gallery->capacity, people);
    }
    /* A person who is replaced has two places for a moment, and a staged record needs one. */
    if ((templates && iso_gallery_memory_reserve(&gallery->memory, (int)templates)) ||
        iso_gallery_memory_reserve_people(&gallery->memory, n) ||
        iso_gallery_access_reserve(&gallery->memory.access, n + 1)) {
        return no_memory(fault);
    }
    return 0;
}

static void discard(struct prepared *prepared, const struct iso_gallery_change *changes, size_t n)
{
    for (size_t i = 0; prepared && i < n; i++) {
        for (size_t t = 0; prepared[i].kept && t < changes[i].item.n; t++) {
            iso_gallery_memory_discard(&prepared[i].kept[t]);
        }
        if (prepared[i].access) {
            sodium_memzero(prepared[i].access, changes[i].access_size);
        }
        free(prepared[i].kept);
        free(prepared[i].access);
    }
    if (prepared) {
        sodium_memzero(prepared, n * sizeof *prepared);
        free(prepared);
    }
}

/* ---- the transaction ---- */

int iso__gallery_put_template(struct iso_gallery *gallery, int64_t person,
                              const struct iso_gallery_item *item, size_t i, int64_t *number,
                              struct iso_fault *fault)
{
    const int error = iso_gallery_db_put_template(gallery->db, person, item->templates[i].algorithm,
                                                  item->templates[i].bytes, item->templates[i].size,
                                                  number, fault);
    if (!error && item->templates[i].excluded) {
        iso_site_record_exclude(iso_gallery_db_site(gallery->db), (uint64_t)*number,
                                (uint64_t)*number + 1);
    }
    return error;
}

static int store_templates(struct iso_gallery *gallery, const struct iso_gallery_change *change,
                           struct prepared *prepared, struct iso_fault *fault)
{
    int error = 0;
    for (size_t i = 0; !error && i < change->item.n; i++) {
        error = iso__gallery_put_template(gallery, prepared->row.id, &change->item, i,
                                          &prepared->kept[i].number, fault);
    }
    return error;
}

/* New templates give a person a new number, so that nothing that was kept under the old one, such
 * as a learned vector, can meet them. */
static int store(struct iso_gallery *gallery, const struct iso_gallery_change *change,
                 struct prepared *prepared, struct iso_fault *fault)
{
    int error = 0;
    if (change->person && (change->remove || !change->keep)) {
        error = iso_gallery_db_drop_person(gallery->db, change->person, fault);
    }
    if (error || change->remove) {
        return error;
    }
    error = iso_gallery_db_put_person(gallery->db, &prepared->row, &prepared->row.id, fault);
    if (!error) {
        error = store_templates(gallery, change, prepared, fault);
    }
    return error ? error
                 : iso_gallery_db_put_access(gallery->db, prepared->row.id, prepared->access,
                                             change->access_size, fault);
}

void iso_gallery_memory_put_person(struct iso_gallery_memory *memory, const struct iso_person *row,
                                   uint32_t unusable)
{
    struct iso_person *own = iso_gallery_memory_find(memory, row->id);
    if (!own) {
        /* A new person has the highest number, so the array stays sorted. */
        own = &memory->people[memory->n_people++];
        own->templates = own->usable = 0;
    }
    const uint32_t templates = own->templates + unusable, usable = own->usable;
    *own = *row;
    own->templates = templates;
    own->usable = usable;
    memory->may_be_learned |= unusable > 0;
}

/* Does in memory what is on the disk now; cannot fail. */
static void follow(struct iso_gallery *gallery, struct iso_gallery_change *change,
                   struct prepared *prepared)
{
    struct iso_gallery_memory *memory = &gallery->memory;
    change->number = change->remove ? 0 : prepared->row.id;
    if (change->person && (change->remove || !change->keep)) {
        iso_gallery_memory_remove(memory, change->person);
    }
    if (change->remove) {
        return;
    }
    iso_gallery_memory_put_person(memory, &prepared->row, prepared->n_unusable);
    for (size_t i = 0; i < change->item.n; i++) {
        if (prepared->usable[i]) {
            iso_gallery_memory_add(memory, &prepared->row, &prepared->kept[i]);
        }
    }
    if (change->access_size > 0) {
        iso_gallery_access_put(&memory->access, prepared->row.id, prepared->access,
                               change->access_size);
        prepared->access = NULL;
    } else {
        iso_gallery_access_remove(&memory->access, prepared->row.id);
    }
}

/* What the templates of a call do to the metric. */
struct teaching {
    bool enrols;   /* there are templates */
    bool excludes; /* some of them do not teach */
};

static struct teaching teaching_of(const struct call *call)
{
    struct teaching teaching = {false, false};
    for (size_t i = 0; i < call->n; i++) {
        const struct iso_gallery_item *item = &call->changes[i].item;
        for (size_t t = 0; !call->changes[i].remove && t < item->n; t++) {
            teaching.enrols = true;
            teaching.excludes |= item->templates[t].excluded;
        }
    }
    return teaching;
}

static int store_all(struct iso_gallery *gallery, const struct call *call,
                     struct prepared *prepared, struct iso_fault *fault)
{
    const struct teaching teaching = teaching_of(call);
    int error = iso__gallery_begin(gallery, fault);
    if (error) {
        return error;
    }
    if (teaching.enrols) {
        iso_gallery_db_mark(gallery->db);
    }
    for (size_t i = 0; !error && i < call->n; i++) {
        iso_work_step(call->listener, call->n + i, 2 * call->n);
        error = store(gallery, &call->changes[i], &prepared[i], fault);
    }
    error = iso__gallery_end(gallery, error, fault);
    if (!error && teaching.excludes && gallery->memory.site) {
        /* Before the templates, so that none of them teaches meanwhile. */
        iso_site_index_set_record(gallery->memory.site, iso_gallery_db_site(gallery->db));
    }
    for (size_t i = 0; !error && i < call->n; i++) {
        follow(gallery, &call->changes[i], &prepared[i]);
    }
    return error;
}

int iso__gallery_apply(struct iso_gallery *gallery, struct iso_gallery_change *changes, size_t n,
                       const struct iso_work_listener *listener, struct iso_fault *fault)
{
    const struct call call = {changes, n, listener};
    int error = iso_gallery_state(gallery, fault);
    if (error) {
        return error;
    }
    struct prepared *prepared = calloc(n ? n : 1, sizeof *prepared);
    if (!prepared) {
        return no_memory(fault);
    }
    for (size_t i = 0; !error && i < n; i++) {
        iso_work_step(listener, i, 2 * n);
        error = prepare(gallery, &call, &changes[i], &prepared[i], fault);
    }
    if (!error) {
        error = check_names(changes, prepared, n, fault);
    }
    if (!error) {
        error = make_room(gallery, changes, n, fault);
    }
    if (!error) {
        error = store_all(gallery, &call, prepared, fault);
    }
    discard(prepared, changes, n);
    return error;
}

int iso_gallery_apply(struct iso_gallery *gallery, struct iso_gallery_change *changes, size_t n,
                      struct iso_fault *fault)
{
    return iso__gallery_apply(gallery, changes, n, NULL, fault);
}
