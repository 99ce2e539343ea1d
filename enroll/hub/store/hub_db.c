#include "enroll/hub/store/hub_db.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ATTEMPTS = 12, PREPARED_MOST = 32, PREPARED_NAME_SIZE = 16 };

struct hub_db {
    PGconn *connection;
    uint64_t generation;
    bool in_transaction;
    const char *prepared[PREPARED_MOST]; /* statements that this connection has planned */
    int n_prepared;
};

/* The first line of a text of the server or the library, without what it puts before it. */
static int say(struct iso_fault *fault, int error, const char *text)
{
    const char *begin = strncmp(text, "ERROR:  ", 8) == 0 ? text + 8 : text;
    const int length = (int)strcspn(begin, "\n");
    return iso_fault_set(fault, error, "the database: %.*s", length > 0 ? length : 9,
                         length > 0 ? begin : "no answer");
}

static bool begins(const char *state, const char *class)
{
    return strncmp(state, class, strlen(class)) == 0;
}

/* The error of an SQLSTATE. */
static int error_of(const char *state)
{
    if (begins(state, "40001") || begins(state, "40P01") || begins(state, "55P03")) {
        return -EAGAIN;
    }
    if (begins(state, "23505")) {
        return -EEXIST;
    }
    if (begins(state, "23503")) {
        return -ENOENT;
    }
    if (begins(state, "53100")) {
        return -ENOSPC;
    }
    return begins(state, "08") || begins(state, "57P") ? -ENOTCONN : -EIO;
}

static int fault_of(const struct hub_db *db, const PGresult *result, struct iso_fault *fault)
{
    const char *state = result ? PQresultErrorField(result, PG_DIAG_SQLSTATE) : NULL;
    const char *text = result ? PQresultErrorField(result, PG_DIAG_MESSAGE_PRIMARY) : NULL;
    if (PQstatus(db->connection) != CONNECTION_OK) {
        return say(fault, -ENOTCONN, PQerrorMessage(db->connection));
    }
    return say(fault, state ? error_of(state) : -EIO, text ? text : PQerrorMessage(db->connection));
}

static void ignore_notice(void *context, const PGresult *result)
{
    (void)context;
    (void)result;
}

/* What every new connection needs. A statement that waits for a lock gives up after some time, so
 * that a hub that hangs does not stop the others for ever. */
static int prepare(struct hub_db *db, struct iso_fault *fault)
{
    if (PQstatus(db->connection) != CONNECTION_OK) {
        return say(fault, -ENOTCONN, PQerrorMessage(db->connection));
    }
    (void)PQsetNoticeReceiver(db->connection, ignore_notice, NULL);
    db->generation++;
    db->n_prepared = 0;
    PGresult *result = PQexec(db->connection, "SET lock_timeout = '30s'");
    const int error = PQresultStatus(result) == PGRES_COMMAND_OK ? 0 : fault_of(db, result, fault);
    PQclear(result);
    return error;
}

int hub_db_open(const char *conninfo, struct hub_db **out, struct iso_fault *fault)
{
    /* What stands before "dbname" are defaults, which conninfo may change. */
    const char *const keywords[] = {"fallback_application_name", "connect_timeout",
                                    "tcp_user_timeout",          "dbname",
                                    "client_encoding",           NULL};
    const char *const values[] = {"isotherm-hub", "10", "20000", conninfo, "UTF8", NULL};
    struct hub_db *db = calloc(1, sizeof *db);
    if (!db) {
        return iso_fault_set(fault, -ENOMEM, "the database: no memory");
    }
    /* A text without '=' would be taken for the name of a database. */
    db->connection = PQconnectdbParams(keywords, values, 1);
    if (!db->connection) {
        free(db);
        return iso_fault_set(fault, -ENOMEM, "the database: no memory");
    }
    const int error = prepare(db, fault);
    if (error) {
        hub_db_close(db);
        return error;
    }
    *out = db;
    return 0;
}

void hub_db_close(struct hub_db *db)
{
    if (db) {
        PQfinish(db->connection);
        free(db);
    }
}

/* Makes a lost connection anew. */
static int connect_again(struct hub_db *db, struct iso_fault *fault)
{
    if (PQstatus(db->connection) == CONNECTION_OK) {
        return 0;
    }
    if (db->in_transaction) {
        return iso_fault_set(fault, -ENOTCONN, "the database: the connection was lost");
    }
    PQreset(db->connection);
    return prepare(db, fault);
}

static int finish(struct hub_db *db, PGresult *done, PGresult **result, struct iso_fault *fault)
{
    const ExecStatusType status = PQresultStatus(done);
    if (status != PGRES_COMMAND_OK && status != PGRES_TUPLES_OK) {
        const int error = fault_of(db, done, fault);
        PQclear(done);
        return error;
    }
    if (result) {
        *result = done;
    } else {
        PQclear(done);
    }
    return 0;
}

int hub_db_run(struct hub_db *db, const char *sql, const struct hub_values *values,
               PGresult **result, struct iso_fault *fault)
{
    static const struct hub_values none;
    const struct hub_values *v = values ? values : &none;
    int formats[HUB_DB_VALUES_MAX];
    const int error = connect_again(db, fault);
    if (error) {
        return error;
    }
    for (size_t i = 0; i < v->n; i++) {
        formats[i] = 1;
    }
    return finish(
        db,
        PQexecParams(db->connection, sql, (int)v->n, v->types, v->values, v->lengths, formats, 1),
        result, fault);
}

/* The number of a planned statement, or a negative error. */
static int prepared(struct hub_db *db, const char *sql, const struct hub_values *v,
                    struct iso_fault *fault)
{
    char name[PREPARED_NAME_SIZE];
    for (int i = 0; i < db->n_prepared; i++) {
        if (db->prepared[i] == sql) {
            return i;
        }
    }
    if (db->n_prepared == PREPARED_MOST) {
        return iso_fault_set(fault, -EIO, "the database: too many statements that run often");
    }
    (void)snprintf(name, sizeof name, "often%d", db->n_prepared);
    const int error = finish(db, PQprepare(db->connection, name, sql, (int)v->n, v->types), NULL,
                             fault);
    if (error) {
        return error;
    }
    db->prepared[db->n_prepared] = sql;
    return db->n_prepared++;
}

int hub_db_run_often(struct hub_db *db, const char *sql, const struct hub_values *values,
                     PGresult **result, struct iso_fault *fault)
{
    static const struct hub_values none;
    const struct hub_values *v = values ? values : &none;
    char name[PREPARED_NAME_SIZE];
    int formats[HUB_DB_VALUES_MAX];
    const int error = connect_again(db, fault);
    const int number = error ? error : prepared(db, sql, v, fault);
    if (number < 0) {
        return number;
    }
    for (size_t i = 0; i < v->n; i++) {
        formats[i] = 1;
    }
    (void)snprintf(name, sizeof name, "often%d", number);
    return finish(
        db, PQexecPrepared(db->connection, name, (int)v->n, v->values, v->lengths, formats, 1),
        result, fault);
}

int hub_db_script(struct hub_db *db, const char *sql, struct iso_fault *fault)
{
    const int error = connect_again(db, fault);
    return error ? error : finish(db, PQexec(db->connection, sql), NULL, fault);
}

/* Waits longer after each attempt, and not the same time as another process. */
static void pause_before(int attempt)
{
    const uint32_t most_ms = 4U << (attempt < 6 ? attempt : 6);
    const uint32_t ms = 1 + randombytes_uniform(most_ms);
    const struct timespec time = {.tv_sec = ms / 1000, .tv_nsec = (long)(ms % 1000) * 1000000};
    (void)nanosleep(&time, NULL);
}

static int commit(struct hub_db *db, struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    PGresult *result = NULL;
    int error = hub_db_run(db, "COMMIT", NULL, &result, &why);
    /* The server answers a COMMIT of a transaction that has failed with ROLLBACK. */
    if (!error && strcmp(PQcmdStatus(result), "COMMIT") != 0) {
        error = iso_fault_set(&why, -EIO, "the database: the transaction had failed before");
    }
    if (!error) {
        PQclear(result);
        return 0;
    }
    PQclear(result);
    return error == -ENOTCONN
               ? iso_fault_set(fault, error,
                               "the database: the connection was lost during the commit; whether "
                               "the change holds is not known")
               : iso_fault_set_code(fault, why.code, error, "%s", why.text);
}

/* One attempt. *again: nothing of it holds, and another one may succeed. */
static int attempt(struct hub_db *db, enum hub_isolation isolation,
                   int (*work)(void *context, struct iso_fault *fault), void *context, bool *again,
                   struct iso_fault *fault)
{
    const char *begin = isolation == HUB_REPEATABLE_READ ? "BEGIN ISOLATION LEVEL REPEATABLE READ"
                                                         : "BEGIN ISOLATION LEVEL READ COMMITTED";
    int error = hub_db_run(db, begin, NULL, NULL, fault);
    *again = error == -ENOTCONN;
    if (error) {
        return error;
    }
    db->in_transaction = true;
    error = work(context, fault);
    *again = error == -EAGAIN || (error == -ENOTCONN && PQstatus(db->connection) != CONNECTION_OK);
    if (!error) {
        error = commit(db, fault);
        *again = error == -EAGAIN;
    } else if (PQstatus(db->connection) == CONNECTION_OK) {
        (void)!hub_db_run(db, "ROLLBACK", NULL, NULL, NULL);
    }
    db->in_transaction = false;
    return error;
}

int hub_db_transaction(struct hub_db *db, enum hub_isolation isolation,
                       int (*work)(void *context, struct iso_fault *fault), void *context,
                       struct iso_fault *fault)
{
    if (db->in_transaction) {
        return work(context, fault);
    }
    bool again = true;
    int error = 0;
    for (int i = 0; i < ATTEMPTS && again; i++) {
        if (i > 0) {
            pause_before(i);
        }
        error = attempt(db, isolation, work, context, &again, fault);
        /* A database that is away is tried twice; the caller decides how long to wait for it. */
        again = again && (error != -ENOTCONN || i == 0);
    }
    return error;
}

PGconn *hub_db_connection(struct hub_db *db)
{
    return db->connection;
}

uint64_t hub_db_generation(const struct hub_db *db)
{
    return db->generation;
}
