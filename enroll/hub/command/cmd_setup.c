/* init, migrate. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/file/file.h"
#include "enroll/hub/broker/hub_ca.h"
#include "enroll/hub/command/hub_command.h"
#include "enroll/hub/store/hub_schema.h"

/* Makes the keys, unless they are there. The keys of a database that has tables are never replaced:
 * new ones could not open it. */
static int make_keys(struct hub_run *run, int64_t version)
{
    struct hub_keys keys;
    const char *path = run->config.key_file;
    int error = hub_keys_read(path, &keys, &run->fault);
    if (error == -ENOENT && version > 0) {
        return iso_fault_set(&run->fault, -EACCES,
                             "%s: is missing, and the database belongs to a hub already; copy the "
                             "key file of this hub",
                             path);
    }
    if (error == -ENOENT) {
        error = hub_keys_make(path, &keys, &run->fault);
        if (!error) {
            printf("made the keys: %s\n", path);
        }
    }
    hub_keys_wipe(&keys);
    return error;
}

static int init(struct hub_run *run)
{
    const char *folder = run->config.folder;
    struct hub_db *db = NULL;
    struct hub_ca *ca = NULL;
    int64_t version = 0;
    if (mkdir(folder, 0700) && errno != EEXIST) {
        return iso_file_fault(folder, -errno, &run->fault);
    }
    int error = hub_db_open(run->config.conninfo, &db, &run->fault);
    error = error ? error : hub_schema_version(db, &version, &run->fault);
    error = error ? error : make_keys(run, version);
    error = error ? error : hub_ca_open(folder, &ca, &run->fault);
    error = error          ? error
            : version == 0 ? hub_schema_migrate(db, (int64_t)hub_migrations_n, &run->fault)
                           : hub_schema_check(db, &run->fault);
    if (!error) {
        printf("the database is of version %zu\n", hub_migrations_n);
    }
    hub_ca_free(ca);
    hub_db_close(db);
    return error;
}

/* The version that "up" or "down" leads to: the newest, or one less; or the one that is named. */
static int goal(struct hub_run *run, int64_t version, int64_t *out)
{
    const struct hub_arguments *a = &run->arguments;
    const bool up = strcmp(a->words[0], "up") == 0;
    char *end = NULL;
    if (!up && strcmp(a->words[0], "down") != 0) {
        return iso_fault_set(&run->fault, -EINVAL, "%s: is neither up nor down", a->words[0]);
    }
    *out = up ? (int64_t)hub_migrations_n : version - 1;
    if (a->n_words == 2) {
        *out = strtoll(a->words[1], &end, 10);
    }
    if ((end && (end == a->words[1] || *end)) || (up ? *out < version : *out >= version) ||
        *out < 0) {
        return iso_fault_set(
            &run->fault, -EINVAL, "the database is of version %lld; %s leads to no %s",
            (long long)version, a->words[0], a->n_words == 2 ? a->words[1] : "other version");
    }
    return 0;
}

static int migrate(struct hub_run *run)
{
    struct hub_db *db = NULL;
    int64_t version = 0, to = 0;
    int error = hub_db_open(run->config.conninfo, &db, &run->fault);
    error = error ? error : hub_schema_version(db, &version, &run->fault);
    error = error ? error : goal(run, version, &to);
    if (!error && to == 0 && version > 0 && !(run->arguments.given & HUB_OPTION_ALL)) {
        error = iso_fault_set(&run->fault, -EACCES,
                              "version 0 has no tables: all people, doors and events would be "
                              "deleted; --all does it");
    }
    error = error ? error : hub_schema_migrate(db, to, &run->fault);
    if (!error) {
        printf("the database is of version %lld\n", (long long)to);
    }
    hub_db_close(db);
    return error;
}

const struct hub_command hub_setup_commands[] = {
    {.words = "init",
     .synopsis = "",
     .help = "make keys, certificate authority and tables, unless they exist",
     .without_store = true,
     .run = init},
    {.words = "migrate",
     .synopsis = "up|down [VERSION] [--all]",
     .help = "bring the tables to another version; --all: also to none",
     .options = HUB_OPTION_ALL,
     .least = 1,
     .most = 2,
     .without_store = true,
     .run = migrate},
    {.words = NULL},
};
