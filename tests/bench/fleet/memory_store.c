#include "tests/bench/fleet/memory_store.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int get_state(void *context, struct iso_fault *fault)
{
    (void)context, (void)fault;
    return 0;
}

static struct iso_gallery_version get_version(void *context)
{
    const struct memory_store *store = context;
    return (struct iso_gallery_version){.gallery = "memory", .changes = store->changes};
}

static const struct iso_person *get_people(void *context, size_t *n)
{
    const struct memory_store *store = context;
    *n = store->n;
    return store->people;
}

static const struct iso_person *find(void *context, const char *name)
{
    const struct memory_store *store = context;
    struct iso_person_name_key key;
    if (iso_person_name_key(name, &key)) {
        return NULL;
    }
    for (size_t i = 0; i < store->n; i++) {
        if (iso_person_name_key_is_same(&store->people[i].key, &key)) {
            return &store->people[i];
        }
    }
    return NULL;
}

static const struct iso_person *find_id(void *context, int64_t person)
{
    const struct memory_store *store = context;
    for (size_t i = 0; i < store->n; i++) {
        if (store->people[i].id == person) {
            return &store->people[i];
        }
    }
    return NULL;
}

static const void *get_access(void *context, int64_t id, size_t *size)
{
    const struct memory_store *store = context;
    const struct iso_person *person = id > 0 ? find_id(context, id) : NULL;
    const struct memory_access *access = id == ISO_GALLERY_FLEET ? &store->record
                                         : person ? &store->accesses[person - store->people]
                                                  : NULL;
    *size = access ? access->size : 0;
    return access && access->size ? access->bytes : NULL;
}

static int keep(struct memory_access *access, const void *bytes, size_t size)
{
    void *copy = size ? malloc(size) : NULL;
    if (size && !copy) {
        return -ENOMEM;
    }
    if (size) {
        memcpy(copy, bytes, size);
    }
    free(access->bytes);
    *access = (struct memory_access){copy, size};
    return 0;
}

static void drop(struct memory_store *store, size_t at)
{
    free(store->accesses[at].bytes);
    store->n--;
    memmove(&store->people[at], &store->people[at + 1], (store->n - at) * sizeof *store->people);
    memmove(&store->accesses[at], &store->accesses[at + 1],
            (store->n - at) * sizeof *store->accesses);
}

static int grow(struct memory_store *store)
{
    if (store->n < store->capacity) {
        return 0;
    }
    const size_t more = store->capacity ? store->capacity + store->capacity / 2 : 8;
    struct iso_person *people = reallocarray(store->people, more, sizeof *people);
    store->people = people ? people : store->people;
    struct memory_access *accesses = reallocarray(store->accesses, more, sizeof *accesses);
    store->accesses = accesses ? accesses : store->accesses;
    if (!people || !accesses) {
        return -ENOMEM;
    }
    store->capacity = more;
    return 0;
}

/* A person who is replaced gets another number, unless the templates stay. */
static int put(struct memory_store *store, struct iso_gallery_change *change)
{
    const struct iso_person *known = change->person ? find_id(store, change->person) : NULL;
    struct iso_person person = change->item.person;
    if (change->person && !known) {
        return -ENOENT;
    }
    int error = iso_person_name_key(person.name, &person.key);
    person.id = change->keep && known ? known->id : ++store->last;
    person.templates = change->keep && known ? known->templates : (uint32_t)change->item.n;
    if (!error && known) {
        drop(store, (size_t)(known - store->people));
    }
    error = error ? error : grow(store);
    if (error) {
        return error;
    }
    store->people[store->n] = person;
    store->accesses[store->n] = (struct memory_access){NULL, 0};
    change->number = person.id;
    return keep(&store->accesses[store->n++], change->access, change->access_size);
}

static int do_change(struct memory_store *store, struct iso_gallery_change *change)
{
    if (!change->remove) {
        return put(store, change);
    }
    const struct iso_person *known = find_id(store, change->person);
    change->number = 0;
    if (!known) {
        return -ENOENT;
    }
    drop(store, (size_t)(known - store->people));
    return 0;
}

/* A failure in between is no transaction; the measurement counts it as a fault and is void then. */
static int apply(void *context, struct iso_gallery_change *changes, size_t n, const void *record,
                 size_t size, struct iso_fault *fault)
{
    struct memory_store *store = context;
    int error = 0;
    for (size_t i = 0; !error && i < n; i++) {
        error = do_change(store, &changes[i]);
    }
    error = error ? error : keep(&store->record, record, size);
    store->changes++;
    return error ? iso_fault_set(fault, error, "the store in memory: %s", strerror(-error)) : 0;
}

static int stage(void *context, const void *record, size_t size, struct iso_fault *fault)
{
    (void)context, (void)record, (void)size;
    return iso_fault_set(fault, -ENOTSUP, "the store in memory has no record of the site");
}

static void unstage(void *context)
{
    (void)context;
}

static int get_templates(void *context, const struct iso_person *person,
                         int (*each)(void *context, const struct iso_gallery_item *item,
                                     struct iso_fault *fault),
                         void *each_context, struct iso_fault *fault)
{
    (void)context, (void)person, (void)each, (void)each_context;
    return iso_fault_set(fault, -ENOTSUP, "the store in memory keeps no templates");
}

struct iso_fleet_store memory_store_table(struct memory_store *store)
{
    return (struct iso_fleet_store){
        .context = store,
        .state = get_state,
        .version = get_version,
        .people = get_people,
        .find = find,
        .find_id = find_id,
        .access = get_access,
        .apply = apply,
        .stage = stage,
        .unstage = unstage,
        .templates = get_templates,
    };
}

void memory_store_done(struct memory_store *store)
{
    while (store->n > 0) {
        drop(store, store->n - 1);
    }
    free(store->people);
    free(store->accesses);
    free(store->record.bytes);
    *store = (struct memory_store){.n = 0};
}
