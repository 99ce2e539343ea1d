/* Measures a fleet of simulated doors, one step at a time; fleet_bench.sh starts the servers and
 * the doors, and calls the steps.
 *
 *   fleet_bench TABLE CONNINFO HUB-FOLDER PIDS PORT STEP WORD...
 *
 *   make N ZONE               makes the table of N doors of a zone
 *   join FIRST N FOLDER       doors join; their certificates are written into the folder
 *   recovery PREFIX SINCE     all doors come back; SINCE: CLOCK_MONOTONIC in nanoseconds
 *   answered PREFIX SINCE     the same after an outage of the hub alone
 *   idle SECONDS              nothing happens
 *   enrol N, revoke N         people come, and go one at a time
 *   revoke-one                one goes, without waiting
 *   visits PREFIX N           each door sends N records of its log
 *   use                       prints the processor seconds of PostgreSQL
 *   now                       prints CLOCK_MONOTONIC
 *
 * PIDS: process_use.h; PORT: that of the broker for the doors. */
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/store/hub_zone.h"
#include "tests/bench/fleet/fleet_measure.h"

void fleet_bench_fail(const char *what, const char *why)
{
    fprintf(stderr, "fleet_bench: %s: %s\n", what, why);
    exit(4);
}

void fleet_bench_print(const char *name, double value)
{
    printf("%s %.6g\n", name, value);
}

static void open_store(struct fleet_bench *bench, const char *conninfo, const char *folder)
{
    struct iso_fault fault = {.text = ""};
    char keys[PATH_MAX];
    (void)snprintf(keys, sizeof keys, "%s/hub.keys", folder);
    const struct hub_store_options options = {
        .conninfo = conninfo, .key_file = keys, .hub_name = "bench", .actor = "bench"};
    if (iso_fleet_start(&fault) || hub_store_open(&options, &bench->store, &fault)) {
        fleet_bench_fail("the hub", fault.text);
    }
}

static void make_table(struct fleet_bench *bench, const char *path, uint32_t n, const char *name)
{
    struct iso_fault fault = {.text = ""};
    struct hub_zone zone;
    if (hub_zone_find(&bench->store, name, &zone, &fault)) {
        fleet_bench_fail("the zone", fault.text);
    }
    fleet_table_make(path, n)->zone = zone.place.zone;
}

static uint32_t number_of(const char *word)
{
    return (uint32_t)strtoul(word, NULL, 10);
}

/* Steps with words after them. Returns false if the step is none of them. */
static bool measure(struct fleet_bench *bench, int n, char **words, const char *folder)
{
    const char *step = words[0];
    if (strcmp(step, "join") == 0 && n == 4) {
        fleet_join(bench, number_of(words[1]), number_of(words[2]), folder, words[3]);
    } else if (strcmp(step, "recovery") == 0 && n == 3) {
        fleet_recovery(bench, words[1], strtoll(words[2], NULL, 10), true);
    } else if (strcmp(step, "answered") == 0 && n == 3) {
        fleet_recovery(bench, words[1], strtoll(words[2], NULL, 10), false);
    } else if (strcmp(step, "idle") == 0 && n == 2) {
        fleet_idle(bench, number_of(words[1]));
    } else if (strcmp(step, "enrol") == 0 && n == 2) {
        fleet_enrol(bench, number_of(words[1]));
    } else if (strcmp(step, "revoke") == 0 && n == 2) {
        fleet_revoke(bench, number_of(words[1]));
    } else if (strcmp(step, "visits") == 0 && n == 3) {
        fleet_visits(bench, words[1], number_of(words[2]));
    } else if (strcmp(step, "revoke-one") == 0) {
        fleet_revoke_one(bench);
    } else if (strcmp(step, "use") == 0) {
        printf("%.6g\n", process_use_now(bench->pids_file).cpu_s[FLEET_POSTGRES]);
    } else {
        return false;
    }
    return true;
}

int main(int argc, char **argv)
{
    static struct fleet_bench bench;
    if (argc == 2 && strcmp(argv[1], "now") == 0) {
        printf("%lld\n", (long long)fleet_table_now_ns());
        return 0;
    }
    if (argc < 7) {
        fprintf(stderr, "usage: fleet_bench TABLE CONNINFO HUB-FOLDER PIDS PORT STEP WORD...\n");
        return 2;
    }
    bench.pids_file = argv[4];
    bench.port = (uint16_t)number_of(argv[5]);
    open_store(&bench, argv[2], argv[3]);
    if (strcmp(argv[6], "make") == 0 && argc == 9) {
        make_table(&bench, argv[1], number_of(argv[7]), argv[8]);
        return 0;
    }
    bench.table = fleet_table_open(argv[1]);
    if (!measure(&bench, argc - 6, argv + 6, argv[3])) {
        fprintf(stderr, "fleet_bench: unknown step %s\n", argv[6]);
        return 2;
    }
    hub_store_close(&bench.store);
    return 0;
}
