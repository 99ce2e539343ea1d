#include "enroll/hub/directory/hub_directory.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/directory/directory_rows.h"
#include "firmware/contract/person_name.h"

struct sync {
    struct hub_store *store;
    const struct hub_directory_run *run;
    struct hub__listed *listed;
    size_t n_listed;
    struct hub_directory_counts counts;
};

const char *hub_directory_change_word(enum hub_directory_change change)
{
    static const char *const words[] = {"added", "changed", "linked", "removed", "failed"};
    return words[change];
}

static void tell(struct sync *sync, enum hub_directory_change change, const char *name,
                 const char *why)
{
    uint64_t *const counts[] = {&sync->counts.added, &sync->counts.changed, &sync->counts.linked,
                                &sync->counts.removed, &sync->counts.failed};
    ++*counts[change];
    if (sync->run->tell) {
        sync->run->tell(sync->run->context, change, name, why);
    }
}

static int by_external(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static int check_twice(const struct hub_named *named, size_t n, struct iso_fault *fault)
{
    const char **ids = calloc(n + 1, sizeof *ids);
    int error = ids ? 0 : iso_fault_set(fault, -ENOMEM, "the directory: no memory");
    for (size_t i = 0; ids && i < n; i++) {
        ids[i] = named[i].external;
    }
    if (ids) {
        qsort(ids, n, sizeof *ids, by_external);
    }
    for (size_t i = 1; !error && i < n; i++) {
        if (strcmp(ids[i - 1], ids[i]) == 0) {
            error = iso_fault_set(fault, -EINVAL, "the directory names %s twice", ids[i]);
        }
    }
    free(ids);
    return error;
}

static int compare(const void *key, const void *listed)
{
    return strcmp(key, ((const struct hub__listed *)listed)->named.external);
}

static struct hub__listed *find(const struct sync *sync, const char *external)
{
    return bsearch(external, sync->listed, sync->n_listed, sizeof *sync->listed, compare);
}

/* Whether somebody may enter somewhere by what the directory says. */
static bool may_enter(const struct hub_named *named)
{
    return named->active && named->n_zones > 0;
}

/* Marks who is named, and counts who would lose the zones. */
static int check_losses(struct sync *sync, const struct hub_named *named, size_t n,
                        struct iso_fault *fault)
{
    uint64_t before = 0, lost = 0;
    for (size_t i = 0; i < n; i++) {
        struct hub__listed *own = find(sync, named[i].external);
        if (own) {
            own->seen = true;
            lost += own->is_named && may_enter(&own->named) && !may_enter(&named[i]);
        }
    }
    for (size_t i = 0; i < sync->n_listed; i++) {
        const struct hub__listed *own = &sync->listed[i];
        const bool entered = own->is_named && may_enter(&own->named);
        before += entered;
        lost += entered && !own->seen;
    }
    return lost * 100 > before * HUB_DIRECTORY_PERCENT && !sync->run->force
               ? iso_fault_set(fault, -EPERM,
                               "%llu of %llu people would lose their zones, which is more than %d "
                               "%%; nothing was changed; --force does it",
                               (unsigned long long)lost, (unsigned long long)before,
                               HUB_DIRECTORY_PERCENT)
               : 0;
}

static enum hub_directory_change change_of(const struct hub__listed *own,
                                           const struct hub_named *named, bool is_named)
{
    if (!own) {
        return HUB_DIRECTORY_ADDED;
    }
    return own->is_named && may_enter(&own->named) && (!is_named || !may_enter(named))
               ? HUB_DIRECTORY_REMOVED
               : HUB_DIRECTORY_CHANGED;
}

/* One person. A fault of one person (a name that another one has) does not stop the others; a
 * fault of the database does. */
static int step(struct sync *sync, const struct hub__listed *own, const struct hub_named *named,
                bool is_named, struct iso_fault *fault)
{
    const bool differs = !own || own->is_astray ||
                         (is_named && hub__directory_differs(own, named)) ||
                         (!is_named && own->is_named);
    const char *flaw = iso_person_name_flaw(named->name);
    struct iso_fault why = {.text = ""};
    bool linked = own && own->has_face && is_named && named->active;
    int error = flaw && is_named ? iso_fault_set(&why, -EINVAL, "%s", flaw) : 0;
    if (!error && named->until_s && named->until_s <= named->from_s) {
        error = iso_fault_set(&why, -EINVAL, "the time ends before it begins");
    }
    if (!differs && !linked) {
        return 0;
    }
    if (!error && !sync->run->dry_run) {
        error = hub__directory_apply(sync->store, sync->run->source, named, is_named, &linked,
                                     &why);
    }
    if (error == -ENOTCONN || error == -EIO || error == -ENOSPC || error == -ENOMEM) {
        return iso_fault_set_code(fault, why.code, error, "%s", why.text);
    }
    if (error) {
        tell(sync, HUB_DIRECTORY_FAILED, named->name, why.text);
        return 0;
    }
    if (differs) {
        tell(sync, change_of(own, named, is_named), named->name, "");
    }
    if (linked) {
        tell(sync, HUB_DIRECTORY_LINKED, named->name, "");
    }
    return 0;
}

static int run_steps(struct sync *sync, const struct hub_named *named, size_t n,
                     struct iso_fault *fault)
{
    int error = 0;
    /* Who leaves goes first, so that a name is free for somebody else. */
    for (size_t i = 0; !error && i < sync->n_listed; i++) {
        struct hub__listed *own = &sync->listed[i];
        if (!own->seen && (own->is_named || own->is_astray)) {
            struct hub_named gone = own->named;
            gone.n_zones = 0;
            error = step(sync, own, &gone, false, fault);
        }
    }
    for (size_t i = 0; !error && i < n; i++) {
        error = step(sync, find(sync, named[i].external), &named[i], true, fault);
    }
    return error;
}

int hub_directory_sync(struct hub_store *store, const struct hub_directory_run *run,
                       const struct hub_named *named, size_t n, struct hub_directory_counts *out,
                       struct iso_fault *fault)
{
    struct sync sync = {.store = store, .run = run, .counts = {.named = n}};
    int error = check_twice(named, n, fault);
    error = error ? error
                  : hub__directory_load(store, run->source, HUB__LISTED_ALL, &sync.listed,
                                        &sync.n_listed, fault);
    error = error ? error : check_losses(&sync, named, n, fault);
    error = error ? error : run_steps(&sync, named, n, fault);
    free(sync.listed);
    if (!error) {
        *out = sync.counts;
    }
    return error;
}

int hub_directory_mend(struct hub_store *store, const char *source, size_t *n,
                       struct iso_fault *fault)
{
    const struct hub_directory_run run = {.source = source};
    struct sync sync = {.store = store, .run = &run};
    int error = hub__directory_load(store, source, HUB__LISTED_DUE, &sync.listed, &sync.n_listed,
                                    fault);
    for (size_t i = 0; !error && i < sync.n_listed; i++) {
        const struct hub__listed *own = &sync.listed[i];
        error = step(&sync, own, &own->named, own->is_named, fault);
    }
    free(sync.listed);
    if (!error) {
        *n = sync.n_listed - sync.counts.failed;
    }
    return error;
}

int hub_directory_each(struct hub_store *store,
                       int (*each)(void *context, const struct hub_directory_entry *entry),
                       void *context, struct iso_fault *fault)
{
    PGresult *rows = NULL;
    int error = hub_db_run(store->db,
                           "SELECT source, external, name, active, valid_from_s, valid_until_s, "
                           "named, person FROM directory ORDER BY name, source, external",
                           NULL, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        struct hub_directory_entry entry = {.source = hub_row_text(rows, i, 0),
                                            .named = {.active = hub_row_switch(rows, i, 3),
                                                      .from_s = hub_row_integer(rows, i, 4),
                                                      .until_s = hub_row_integer(rows, i, 5)},
                                            .is_named = hub_row_switch(rows, i, 6),
                                            .is_linked = !PQgetisnull(rows, i, 7),
                                            .person = hub_row_id(rows, i, 7)};
        (void)snprintf(entry.named.external, sizeof entry.named.external, "%s",
                       hub_row_text(rows, i, 1));
        (void)snprintf(entry.named.name, sizeof entry.named.name, "%s", hub_row_text(rows, i, 2));
        error = each(context, &entry);
    }
    PQclear(rows);
    return error;
}
