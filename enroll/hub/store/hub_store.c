#include "enroll/hub/store/hub_store.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "enroll/hub/store/hub_schema.h"
#include "firmware/contract/person_name.h"

static int64_t wall_clock_s(void)
{
    return time(NULL);
}

int hub_name_take(const char *what, const char *name, char out[HUB_NAME_SIZE],
                  struct iso_fault *fault)
{
    const char *flaw = iso_person_name_flaw(name);
    struct iso_fleet_id id;
    if (flaw) {
        return iso_fault_set(fault, -EINVAL, "%s: %s", what, flaw);
    }
    if (strlen(name) >= HUB_NAME_SIZE) {
        return iso_fault_set(fault, -EINVAL, "%s: the name is longer than %d bytes", what,
                             HUB_NAME_SIZE - 1);
    }
    /* A name must not be taken for an id. */
    if (iso_fleet_id_read(name, &id) == 0) {
        return iso_fault_set(fault, -EINVAL, "%s: the name has the form of an id", what);
    }
    (void)snprintf(out, HUB_NAME_SIZE, "%s", name);
    return 0;
}

int hub_store_open(const struct hub_store_options *options, struct hub_store *out,
                   struct iso_fault *fault)
{
    struct hub_store store = {.now_s = wall_clock_s};
    int error = hub_name_take("hub", options->hub_name, store.hub_name, fault);
    if (error) {
        return error;
    }
    (void)snprintf(store.actor, sizeof store.actor, "%s", options->actor);
    const char *slash = strrchr(options->key_file, '/');
    const int length = slash ? (int)(slash - options->key_file) : 1;
    if (snprintf(store.updates, sizeof store.updates, "%.*s/updates", length,
                 slash ? options->key_file : ".") >= (int)sizeof store.updates) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: the path is too long", options->key_file);
    }
    error = hub_keys_read(options->key_file, &store.keys, fault);
    error = error ? error : hub_db_open(options->conninfo, &store.db, fault);
    error = error ? error : hub_schema_check(store.db, fault);
    if (error) {
        hub_store_close(&store);
        return error;
    }
    *out = store;
    hub_keys_wipe(&store.keys);
    return 0;
}

void hub_store_close(struct hub_store *store)
{
    hub_db_close(store->db);
    store->db = NULL;
    hub_keys_wipe(&store->keys);
}
