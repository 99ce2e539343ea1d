/* The tables of a hub, in versions. Each version has one file of statements that makes it from the
 * version before, and one that goes back (schema/NNNN_NAME.up.sql, .down.sql), which are part of
 * the program. The table isotherm_schema contains the version. */
#ifndef ISO_ENROLL_HUB_STORE_HUB_SCHEMA_H
#define ISO_ENROLL_HUB_STORE_HUB_SCHEMA_H

#include "enroll/hub/store/hub_db.h"

struct hub_migration {
    const char *name, *up, *down;
};

/* The migrations that this program knows, oldest first. hub_migrations[i] brings the database from
 * version i to version i + 1. */
extern const struct hub_migration hub_migrations[];
extern const size_t hub_migrations_n;

/* The version of the database; 0: it has no tables of a hub. */
int hub_schema_version(struct hub_db *db, int64_t *version, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* -ENODATA the database has no tables of a hub, -EPROTONOSUPPORT it is of another version than this
 * program: older ("run isotherm-hub migrate up") or newer. */
int hub_schema_check(struct hub_db *db, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Brings the database to a version, 0 to hub_migrations_n, each step in a transaction of its own.
 * -EPROTONOSUPPORT the database is newer than the program; -EINVAL there is no such version. */
int hub_schema_migrate(struct hub_db *db, int64_t version, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
