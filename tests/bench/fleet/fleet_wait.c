/* Waiting for the doors, and what is used meanwhile. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "firmware/fleet/link/link.h"
#include "tests/bench/fleet/fleet_measure.h"

enum { LOOK_MS = 10, ASK_MS = 200 };

/* ---- use ---- */

void fleet_use_begin(const struct fleet_bench *bench, struct fleet_use *use)
{
    *use = (struct fleet_use){.begin = process_use_now(bench->pids_file)};
    use->last = use->end = use->begin;
}

void fleet_use_look(const struct fleet_bench *bench, struct fleet_use *use)
{
    const double passed_s = 1e-9 * (double)(fleet_table_now_ns() - use->last.at_ns);
    if (passed_s < 1) {
        return;
    }
    use->end = process_use_now(bench->pids_file);
    for (int part = 0; part < FLEET_PARTS; part++) {
        const double cpu = (use->end.cpu_s[part] - use->last.cpu_s[part]) / passed_s;
        use->most_cpu[part] = cpu > use->most_cpu[part] ? cpu : use->most_cpu[part];
    }
    use->last = use->end;
}

void fleet_use_end(const struct fleet_bench *bench, struct fleet_use *use)
{
    use->end = process_use_now(bench->pids_file);
}

void fleet_use_print(const struct fleet_use *use, const char *prefix, double things)
{
    for (enum fleet_part part = 0; part < FLEET_PARTS; part++) {
        char name[96];
        (void)snprintf(name, sizeof name, "%s_cpu_us_%s", prefix, fleet_part_name(part));
        fleet_bench_print(name, 1e6 * (use->end.cpu_s[part] - use->begin.cpu_s[part]) / things);
    }
}

/* ---- waiting ---- */

static void pause_ms(long ms)
{
    const struct timespec time = {.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000};
    (void)nanosleep(&time, NULL);
}

/* Whether a door has what is waited for. */
typedef bool fleet_has(const struct fleet_table_door *door, int64_t goal);

/* A door that has it keeps it, so the doors are looked at in their order. */
static void wait_for(const struct fleet_bench *bench, struct fleet_use *use, fleet_has *has,
                     int64_t goal, const char *what, double most_s)
{
    const int64_t until_ns = fleet_table_now_ns() + (int64_t)(most_s * 1e9);
    for (uint32_t i = 0; i < bench->table->n;) {
        if (has(&bench->table->doors[i], goal)) {
            i++;
            continue;
        }
        if (fleet_table_now_ns() > until_ns) {
            char why[80];
            (void)snprintf(why, sizeof why, "door %u has not after %.0f s", i, most_s);
            fleet_bench_fail(what, why);
        }
        pause_ms(LOOK_MS);
        fleet_use_look(bench, use);
    }
}

static bool has_applied(const struct fleet_table_door *door, int64_t goal)
{
    return atomic_load(&door->sequence) >= (uint64_t)goal;
}

static bool has_sent(const struct fleet_table_door *door, int64_t goal)
{
    const uint64_t last = atomic_load(&door->last_event);
    return last >= (uint64_t)goal && atomic_load(&door->events_acked) >= last;
}

static bool is_online(const struct fleet_table_door *door, int64_t goal)
{
    return atomic_load(&door->phase) == LINK_ONLINE && atomic_load(&door->online_ns) > goal;
}

void fleet_wait_applied(const struct fleet_bench *bench, struct fleet_use *use, uint64_t sequence,
                        double most_s)
{
    wait_for(bench, use, has_applied, (int64_t)sequence, "the change", most_s);
}

void fleet_wait_events(const struct fleet_bench *bench, struct fleet_use *use, uint64_t least,
                       double most_s)
{
    wait_for(bench, use, has_sent, (int64_t)least, "the log", most_s);
}

void fleet_wait_online(const struct fleet_bench *bench, struct fleet_use *use, int64_t since_ns,
                       double most_s)
{
    wait_for(bench, use, is_online, since_ns, "the lease", most_s);
}

static int64_t confirmed(struct fleet_bench *bench, uint64_t sequence)
{
    struct iso_fault fault = {.text = ""};
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, &bench->table->zone);
    hub_value_integer(&values, (int64_t)sequence);
    if (hub_db_run(bench->store.db,
                   "SELECT count(*) FROM door_place WHERE zone = $1 AND sequence >= $2", &values,
                   &rows, &fault)) {
        fleet_bench_fail("the places of the doors", fault.text);
    }
    const int64_t n = hub_row_integer(rows, 0, 0);
    PQclear(rows);
    return n;
}

void fleet_wait_confirmed(struct fleet_bench *bench, struct fleet_use *use, uint64_t sequence,
                          double most_s)
{
    const int64_t until_ns = fleet_table_now_ns() + (int64_t)(most_s * 1e9);
    int64_t n = 0;
    while ((n = confirmed(bench, sequence)) < bench->table->n) {
        if (fleet_table_now_ns() > until_ns) {
            char why[80];
            (void)snprintf(why, sizeof why, "%lld of %u doors after %.0f s", (long long)n,
                           bench->table->n, most_s);
            fleet_bench_fail("the confirmation", why);
        }
        pause_ms(ASK_MS);
        fleet_use_look(bench, use);
    }
}

/* ---- distributions ---- */

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The smallest value that so large a share of all does not exceed. */
static double quantile(const double *sorted, size_t n, double share)
{
    const size_t rank = (size_t)(share * (double)n + 0.999999);
    return sorted[rank > 0 ? rank - 1 : 0];
}

void fleet_print_spread(const char *prefix, double *values, size_t n)
{
    static const struct {
        const char *name;
        double share;
    } ranks[] = {{"p50", 0.5}, {"p99", 0.99}, {"p999", 0.999}, {"max", 1}};
    qsort(values, n, sizeof *values, compare);
    for (size_t i = 0; n > 0 && i < sizeof ranks / sizeof *ranks; i++) {
        char name[96];
        (void)snprintf(name, sizeof name, "%s_%s", prefix, ranks[i].name);
        fleet_bench_print(name, quantile(values, n, ranks[i].share));
    }
}
