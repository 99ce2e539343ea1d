/* The naive way, for comparison: every door asks a table of changes every so many seconds whether
 * there is something new. The doors share a few connections, each in a thread; nothing is verified
 * or opened.
 *
 *   fleet_poll CONNINFO DOORS INTERVAL-S CHANGES
 *
 * A change is committed, and when all doors have seen it, the next one. Prints "poll_..." lines:
 * the delay from before the commit until a door has read the change, how many polls a second were
 * made, and of how many a second there was need. */
#include <arpa/inet.h>
#include <libpq-fe.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/bench/fleet/fleet_table.h"

enum { CONNECTIONS = 4, CHANGES_MOST = 64 };

struct poller {
    PGconn *connection;
    pthread_t thread;
    uint32_t n;        /* doors; that of number i is due at i / n of each interval */
    int64_t *seen;     /* [n] the last change that each door has read */
    double *delays_ms; /* [n * changes] */
    size_t n_delays;
    uint64_t polls;
};

static struct {
    const char *conninfo;
    double interval_s;
    int64_t changes;
    int64_t committed_ns[CHANGES_MOST + 1]; /* by the number; written before the change */
    _Atomic uint32_t waiting;               /* doors that have not read the newest change */
    _Atomic bool is_ending;
} poll;

static _Noreturn void fail(PGconn *connection)
{
    fprintf(stderr, "fleet_poll: %s", PQerrorMessage(connection));
    exit(4);
}

static PGconn *open_connection(void)
{
    PGconn *connection = PQconnectdb(poll.conninfo);
    if (PQstatus(connection) != CONNECTION_OK) {
        fail(connection);
    }
    return connection;
}

static void run(PGconn *connection, const char *sql)
{
    PGresult *result = PQexec(connection, sql);
    if (PQresultStatus(result) != PGRES_COMMAND_OK) {
        fail(connection);
    }
    PQclear(result);
}

static void take(struct poller *poller, uint32_t door, const PGresult *rows)
{
    const int64_t now_ns = fleet_table_now_ns();
    for (int i = 0; i < PQntuples(rows); i++) {
        const int64_t number = strtoll(PQgetvalue(rows, i, 0), NULL, 10);
        poller->seen[door] = number;
        poller->delays_ms[poller->n_delays++] = 1e-6 * (double)(now_ns - poll.committed_ns[number]);
        atomic_fetch_sub(&poll.waiting, 1);
    }
}

static void ask(struct poller *poller, uint32_t door)
{
    char seen[24];
    const char *const values[] = {seen};
    (void)snprintf(seen, sizeof seen, "%lld", (long long)poller->seen[door]);
    PGresult *rows = PQexecPrepared(poller->connection, "poll", 1, values, NULL, NULL, 0);
    if (PQresultStatus(rows) != PGRES_TUPLES_OK) {
        fail(poller->connection);
    }
    poller->polls++;
    take(poller, door, rows);
    PQclear(rows);
}

/* A poll that is late is made at once; the following ones keep their own moments. */
static void *work(void *context)
{
    struct poller *poller = context;
    const int64_t begin_ns = fleet_table_now_ns();
    const double step_ns = 1e9 * poll.interval_s / poller->n;
    for (uint64_t turn = 0; !atomic_load(&poll.is_ending); turn++) {
        const int64_t wait_ns = begin_ns + (int64_t)(step_ns * (double)turn) - fleet_table_now_ns();
        if (wait_ns > 0) {
            const struct timespec time = {.tv_sec = wait_ns / 1000000000,
                                          .tv_nsec = wait_ns % 1000000000};
            (void)nanosleep(&time, NULL);
        }
        ask(poller, (uint32_t)(turn % poller->n));
    }
    return NULL;
}

static void start(struct poller *poller, uint32_t n)
{
    poller->n = n;
    poller->seen = calloc(n, sizeof *poller->seen);
    poller->delays_ms = calloc((size_t)n * (size_t)poll.changes, sizeof *poller->delays_ms);
    poller->connection = open_connection();
    PGresult *prepared = PQprepare(poller->connection, "poll",
                                   "SELECT number, person FROM naive_change WHERE number > $1 "
                                   "ORDER BY number",
                                   1, NULL);
    if (!poller->seen || !poller->delays_ms || PQresultStatus(prepared) != PGRES_COMMAND_OK) {
        fail(poller->connection);
    }
    PQclear(prepared);
    if (pthread_create(&poller->thread, NULL, work, poller)) {
        fail(poller->connection);
    }
}

static void pause_ms(long ms)
{
    const struct timespec time = {.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000};
    (void)nanosleep(&time, NULL);
}

/* Changes come at moments that have nothing to do with those of the polls. */
static void make_changes(PGconn *connection, uint32_t doors)
{
    for (int64_t number = 1; number <= poll.changes; number++) {
        char sql[128];
        pause_ms(100 + random() % 900);
        (void)snprintf(sql, sizeof sql, "INSERT INTO naive_change VALUES (%lld, gen_random_uuid())",
                       (long long)number);
        atomic_store(&poll.waiting, doors);
        poll.committed_ns[number] = fleet_table_now_ns();
        run(connection, sql);
        while (atomic_load(&poll.waiting) > 0) {
            pause_ms(10);
        }
    }
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_delays(const struct poller *pollers, size_t n)
{
    double *all = calloc(n, sizeof *all);
    size_t kept = 0;
    for (int i = 0; all && i < CONNECTIONS; i++) {
        memcpy(all + kept, pollers[i].delays_ms, pollers[i].n_delays * sizeof *all);
        kept += pollers[i].n_delays;
    }
    if (!all || kept != n) {
        fprintf(stderr, "fleet_poll: %zu delays instead of %zu\n", kept, n);
        exit(4);
    }
    qsort(all, n, sizeof *all, compare);
    printf("poll_ms_p50 %.6g\npoll_ms_p99 %.6g\npoll_ms_max %.6g\n", all[n / 2], all[n * 99 / 100],
           all[n - 1]);
    free(all);
}

int main(int argc, char **argv)
{
    static struct poller pollers[CONNECTIONS];
    uint64_t polls = 0;
    if (argc != 5) {
        fprintf(stderr, "usage: fleet_poll CONNINFO DOORS INTERVAL-S CHANGES\n");
        return 2;
    }
    poll.conninfo = argv[1];
    const uint32_t doors = (uint32_t)strtoul(argv[2], NULL, 10) / CONNECTIONS * CONNECTIONS;
    poll.interval_s = strtod(argv[3], NULL);
    poll.changes = strtoll(argv[4], NULL, 10);
    if (doors == 0 || poll.interval_s <= 0 || poll.changes < 1 || poll.changes > CHANGES_MOST) {
        fprintf(stderr, "fleet_poll: at least %d doors, and 1 to %d changes\n", CONNECTIONS,
                CHANGES_MOST);
        return 2;
    }
    PGconn *connection = open_connection();
    run(connection, "SET client_min_messages = error");
    run(connection, "DROP TABLE IF EXISTS naive_change");
    run(connection, "CREATE TABLE naive_change (number bigint PRIMARY KEY, person uuid)");
    const int64_t begun_ns = fleet_table_now_ns();
    for (int i = 0; i < CONNECTIONS; i++) {
        start(&pollers[i], doors / CONNECTIONS);
    }
    make_changes(connection, doors);
    atomic_store(&poll.is_ending, true);
    for (int i = 0; i < CONNECTIONS; i++) {
        (void)pthread_join(pollers[i].thread, NULL);
        polls += pollers[i].polls;
        PQfinish(pollers[i].connection);
    }
    const double took_s = 1e-9 * (double)(fleet_table_now_ns() - begun_ns);
    PQfinish(connection);
    printf("poll_interval_s %g\npoll_a_second %.6g\npoll_wanted_a_second %.6g\npoll_s %.6g\n",
           poll.interval_s, (double)polls / took_s, doors / poll.interval_s, took_s);
    print_delays(pollers, (size_t)doors * (size_t)poll.changes);
    return 0;
}
