/* Doors at rest, and after an outage. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "tests/bench/fleet/fleet_measure.h"

enum { WAIT_S = 600, WINDOWS = WAIT_S };

static double sum(const struct fleet_bench *bench, size_t offset)
{
    double all = 0;
    for (uint32_t i = 0; i < bench->table->n; i++) {
        const char *row = (const char *)&bench->table->doors[i];
        all += (double)atomic_load((const _Atomic uint64_t *)(const void *)(row + offset));
    }
    return all;
}

static void print_memory(const struct fleet_use *use)
{
    for (enum fleet_part part = 0; part < FLEET_PARTS; part++) {
        char name[96];
        (void)snprintf(name, sizeof name, "memory_mb_%s", fleet_part_name(part));
        fleet_bench_print(name, use->end.mb[part]);
    }
}

void fleet_idle(struct fleet_bench *bench, double seconds)
{
    struct fleet_use use;
    const struct timespec time = {.tv_sec = (time_t)seconds};
    const double door_seconds = seconds * bench->table->n;
    const size_t questions = offsetof(struct fleet_table_door, questions);
    const double before = sum(bench, questions), bytes = process_use_bytes(bench->port);
    fleet_use_begin(bench, &use);
    (void)nanosleep(&time, NULL);
    fleet_use_end(bench, &use);
    fleet_bench_print("idle_questions_a_second", (sum(bench, questions) - before) / seconds);
    fleet_bench_print("idle_bytes_a_minute",
                      60 * (process_use_bytes(bench->port) - bytes) / door_seconds);
    fleet_use_print(&use, "idle", door_seconds);
    print_memory(&use);
    fleet_bench_print("faults", sum(bench, offsetof(struct fleet_table_door, faults)));
}

/* The most doors that came in one second. */
static double most_a_second(const double *seconds, uint32_t n)
{
    static uint32_t windows[WINDOWS];
    uint32_t most = 0;
    for (int i = 0; i < WINDOWS; i++) {
        windows[i] = 0;
    }
    for (uint32_t i = 0; i < n; i++) {
        const int at = seconds[i] > 0 ? (int)seconds[i] : 0;
        if (at < WINDOWS && ++windows[at] > most) {
            most = windows[at];
        }
    }
    return most;
}

static void print_with(const char *prefix, const char *what, double value)
{
    char name[96];
    (void)snprintf(name, sizeof name, "%s_%s", prefix, what);
    fleet_bench_print(name, value);
}

static double *seconds_of(const struct fleet_bench *bench, int64_t since_ns, uint64_t sequence)
{
    double *seconds = calloc(bench->table->n, sizeof *seconds);
    if (!seconds) {
        fleet_bench_fail("the delays", "out of memory");
    }
    for (uint32_t i = 0; i < bench->table->n; i++) {
        const struct fleet_table_door *door = &bench->table->doors[i];
        const int64_t at = sequence ? atomic_load(&door->applied_ns[sequence])
                                    : atomic_load(&door->online_ns);
        seconds[i] = 1e-9 * (double)(at - since_ns);
    }
    return seconds;
}

void fleet_recovery(struct fleet_bench *bench, const char *prefix, int64_t since_ns,
                    bool is_connected)
{
    struct fleet_use use;
    char name[96], part_name[32];
    const uint64_t sequence = fleet_sequence(bench);
    const size_t connections = offsetof(struct fleet_table_door, connections);
    const size_t failed = offsetof(struct fleet_table_door, failed_fetches);
    fleet_use_begin(bench, &use);
    if (is_connected) {
        fleet_wait_online(bench, &use, since_ns, WAIT_S);
        double *seconds = seconds_of(bench, since_ns, 0);
        (void)snprintf(name, sizeof name, "%s_online_s", prefix);
        print_with(prefix, "most_a_second", most_a_second(seconds, bench->table->n));
        fleet_print_spread(name, seconds, bench->table->n);
        free(seconds);
    }
    if (sequence > 0) {
        fleet_wait_applied(bench, &use, sequence, WAIT_S);
        double *seconds = seconds_of(bench, since_ns, sequence);
        (void)snprintf(name, sizeof name, "%s_level_s", prefix);
        fleet_print_spread(name, seconds, bench->table->n);
        free(seconds);
        fleet_wait_confirmed(bench, &use, sequence, WAIT_S);
        print_with(prefix, "confirmed_s", 1e-9 * (double)(fleet_table_now_ns() - since_ns));
    }
    fleet_use_end(bench, &use);
    print_with(prefix, "connections", sum(bench, connections) / bench->table->n);
    print_with(prefix, "failed_fetches", sum(bench, failed) / bench->table->n);
    for (enum fleet_part part = 0; part < FLEET_PARTS; part++) {
        (void)snprintf(part_name, sizeof part_name, "most_cpu_%s", fleet_part_name(part));
        print_with(prefix, part_name, use.most_cpu[part]);
    }
    fleet_use_print(&use, prefix, bench->table->n);
}
