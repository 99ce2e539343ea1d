/* The connection to PostgreSQL. Every statement has its values as parameters; no value is ever a
 * part of a statement's text. Values and results travel in PostgreSQL's binary form.
 *
 * One connection belongs to one thread. Errors of all functions, with a fault:
 *   -ENOTCONN the database does not answer, or has closed the connection
 *   -EEXIST   a name or key exists already
 *   -ENOENT   a row that is referred to does not exist
 *   -EAGAIN   another transaction was in the way (hub_db_transaction tries again)
 *   -ENOSPC   the database's disk is full
 *   -EIO      any other refusal of the database; -ENOMEM */
#ifndef ISO_ENROLL_HUB_STORE_HUB_DB_H
#define ISO_ENROLL_HUB_STORE_HUB_DB_H

#include <libpq-fe.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "firmware/fleet/message/fleet_id.h"

struct hub_db;

/* Connects. `conninfo` is libpq's connection string. The caller closes *out. */
int hub_db_open(const char *conninfo, struct hub_db **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* NULL is accepted. */
void hub_db_close(struct hub_db *db);

/* The values of one statement, $1, $2, ... in the order of the calls. All zero is empty. */
enum { HUB_DB_VALUES_MAX = 20 };

struct hub_values {
    size_t n;
    Oid types[HUB_DB_VALUES_MAX];
    const char *values[HUB_DB_VALUES_MAX];
    int lengths[HUB_DB_VALUES_MAX];
    uint8_t numbers[HUB_DB_VALUES_MAX][8];
};

/* Texts, bytes and ids are not copied: they outlive the statement. NULL becomes SQL's NULL. */
void hub_value_integer(struct hub_values *values, int64_t value);
void hub_value_switch(struct hub_values *values, bool value);
void hub_value_text(struct hub_values *values, const char *text);
void hub_value_bytes(struct hub_values *values, const void *bytes, size_t size);
void hub_value_id(struct hub_values *values, const struct iso_fleet_id *id);

/* Runs one statement. `values` may be NULL. The caller clears *result (PQclear); `result` may be
 * NULL. A connection that was lost is made anew first, but not within a transaction. */
int hub_db_run(struct hub_db *db, const char *sql, const struct hub_values *values,
               PGresult **result, struct iso_fault *fault) __attribute__((warn_unused_result));

/* The same for a statement that runs very often: the database plans it once for each connection.
 * Its text is a constant that lives as long as the program, and its values have the same types each
 * time. The plan does not depend on the values, so it has to be the right one for all of them. */
int hub_db_run_often(struct hub_db *db, const char *sql, const struct hub_values *values,
                     PGresult **result, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Runs several statements without values, separated by ';'. For the schema. */
int hub_db_script(struct hub_db *db, const char *sql, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* How many rows the statement has changed. */
int64_t hub_db_changed(const PGresult *result);

/* A field of a result: bigint, boolean, text, bytea, uuid, in this order. The statement must
 * deliver this type. SQL's NULL is 0, false, "", NULL with size 0, or zeros. Texts and bytes belong
 * to the result. */
int64_t hub_row_integer(const PGresult *result, int row, int column);
bool hub_row_switch(const PGresult *result, int row, int column);
const char *hub_row_text(const PGresult *result, int row, int column);
const uint8_t *hub_row_bytes(const PGresult *result, int row, int column, size_t *size);
struct iso_fleet_id hub_row_id(const PGresult *result, int row, int column);

/* Copies exactly `size` bytes of a bytea. -EBADMSG it has another size. */
int hub_row_copy(const PGresult *result, int row, int column, void *out, size_t size)
    __attribute__((warn_unused_result));

enum hub_isolation {
    HUB_READ_COMMITTED,  /* writers lock the rows that they change */
    HUB_REPEATABLE_READ, /* everything is read as it was at one moment */
};

/* Runs `work` in a transaction and commits it if `work` returns 0; else rolls it back and returns
 * the error. A deadlock, a failure of serialization and a connection that was lost before the
 * commit start it again, some times at most, so `work` must have no effect outside of the database
 * before it is done. If the connection is lost during the commit, nobody knows whether the
 * transaction holds: -ENOTCONN with a fault that says so. Within a transaction, `work` simply runs
 * as a part of it. */
int hub_db_transaction(struct hub_db *db, enum hub_isolation isolation,
                       int (*work)(void *context, struct iso_fault *fault), void *context,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* The connection itself, and how often it has been made: a lock of the session is lost with it. */
PGconn *hub_db_connection(struct hub_db *db);
uint64_t hub_db_generation(const struct hub_db *db);

#endif
