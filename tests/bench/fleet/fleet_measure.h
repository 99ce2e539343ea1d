/* The parts of fleet_bench. Each measurement prints lines "NAME VALUE", which fleet_law.py reads.
 */
#ifndef TESTS_BENCH_FLEET_FLEET_MEASURE_H
#define TESTS_BENCH_FLEET_FLEET_MEASURE_H

#include <stdbool.h>

#include "enroll/hub/store/hub_store.h"
#include "tests/bench/fleet/fleet_table.h"
#include "tests/bench/fleet/process_use.h"

struct fleet_bench {
    struct fleet_table *table;
    struct hub_store store; /* the hub's database, with its keys */
    const char *pids_file;  /* process_use.h */
    uint16_t port;          /* of the broker, for the doors */
};

/* Ends the program with a line. */
_Noreturn void fleet_bench_fail(const char *what, const char *why);

void fleet_bench_print(const char *name, double value);

/* ---- fleet_join.c ---- */

/* Lets the doors `first` ... `first + n - 1` of the table join the zone: each gets its keys, its
 * membership and its certificate, which is written into `folder`. `authority`: the folder of the
 * hub's authority. */
void fleet_join(struct fleet_bench *bench, uint32_t first, uint32_t n, const char *authority,
                const char *folder);

/* ---- fleet_wait.c ---- */

/* What is used while something is waited for: the sum, and the most in a second. */
struct fleet_use {
    struct process_use begin, last, end;
    double most_cpu[FLEET_PARTS]; /* processor seconds a second */
};

void fleet_use_begin(const struct fleet_bench *bench, struct fleet_use *use);
void fleet_use_look(const struct fleet_bench *bench, struct fleet_use *use); /* once a second */
void fleet_use_end(const struct fleet_bench *bench, struct fleet_use *use);

/* Prints PREFIX_cpu_us_PART: microseconds of each part for each of so many things. */
void fleet_use_print(const struct fleet_use *use, const char *prefix, double things);

/* Waits until all doors are at this sequence of the zone. */
void fleet_wait_applied(const struct fleet_bench *bench, struct fleet_use *use, uint64_t sequence,
                        double most_s);

/* Waits until the database has this sequence, or a later one, of all doors. */
void fleet_wait_confirmed(struct fleet_bench *bench, struct fleet_use *use, uint64_t sequence,
                          double most_s);

/* Waits until all records of all logs are acknowledged: `least` records of each door at least. */
void fleet_wait_events(const struct fleet_bench *bench, struct fleet_use *use, uint64_t least,
                       double most_s);

/* Waits until all doors have a lease of a connection that is younger than this moment. */
void fleet_wait_online(const struct fleet_bench *bench, struct fleet_use *use, int64_t since_ns,
                       double most_s);

/* Prints PREFIX_p50, _p99, _p999 and _max of values, which are sorted. */
void fleet_print_spread(const char *prefix, double *values, size_t n);

/* ---- fleet_change.c ---- */

/* The sequence of the zone in the database. */
uint64_t fleet_sequence(struct fleet_bench *bench);

/* Enrols n people one after the other, and waits until all doors have all of them. */
void fleet_enrol(struct fleet_bench *bench, uint32_t n);

/* Revokes n people, each when all doors have confirmed the one before. */
void fleet_revoke(struct fleet_bench *bench, uint32_t n);

/* Revokes one person without waiting, for an outage. */
void fleet_revoke_one(struct fleet_bench *bench);

/* Each door makes n records of visits; waits until the database has all of them: PREFIX_each,
 * PREFIX_a_second, and the records that are in the database without a reason. */
void fleet_visits(struct fleet_bench *bench, const char *prefix, uint32_t n);

/* ---- fleet_stand.c ---- */

/* Nothing happens for some seconds. */
void fleet_idle(struct fleet_bench *bench, double seconds);

/* Waits until all doors are back after an outage that ended at `since_ns`: PREFIX_online_s_...
 * their leases, PREFIX_level_s_... the newest change, and the largest use in a second. With
 * `is_connected` the doors had lost the broker. */
void fleet_recovery(struct fleet_bench *bench, const char *prefix, int64_t since_ns,
                    bool is_connected);

#endif
