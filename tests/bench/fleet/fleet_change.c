/* Enrolments, revocations and visits. */
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "enroll/hub/people/hub_person.h"
#include "enroll/hub/store/hub_zone.h"
#include "tests/bench/fleet/fleet_measure.h"

enum {
    TEMPLATE_BYTES = 10000, /* about a person's templates in a gallery */
    WAIT_S = 400,
};

uint64_t fleet_sequence(struct fleet_bench *bench)
{
    struct iso_fault fault = {.text = ""};
    struct hub_zone zone;
    char text[ISO_FLEET_ID_TEXT_SIZE];
    if (hub_zone_find(&bench->store, iso_fleet_id_text(&bench->table->zone, text), &zone, &fault)) {
        fleet_bench_fail("the zone", fault.text);
    }
    if (zone.place.sequence >= FLEET_TABLE_CHANGES_MOST) {
        fleet_bench_fail("the zone", "it has had too many changes for the table");
    }
    return zone.place.sequence;
}

static struct iso_fleet_id id_of(uint32_t person)
{
    return iso_fleet_id_of(&person, sizeof person);
}

static void put_person(struct fleet_bench *bench)
{
    static uint8_t bytes[TEMPLATE_BYTES];
    struct iso_fault fault = {.text = ""};
    const uint32_t number = bench->table->people++;
    char name[32];
    (void)snprintf(name, sizeof name, "person %u", number);
    randombytes_buf(bytes, sizeof bytes); /* compression must not make them smaller */
    const struct iso_fleet_person person = {.id = id_of(number),
                                            .name = name,
                                            .name_length = strlen(name),
                                            .enrolled_s = bench->store.now_s(),
                                            .n = 1,
                                            .templates = {{1, sizeof bytes, bytes}}};
    if (hub_person_put(&bench->store, &person, &bench->table->zone, 1, &fault)) {
        fleet_bench_fail("an enrolment", fault.text);
    }
}

void fleet_revoke_one(struct fleet_bench *bench)
{
    struct iso_fault fault = {.text = ""};
    const struct iso_fleet_id person = id_of(bench->table->revoked++);
    if (hub_person_revoke(&bench->store, &person, &fault)) {
        fleet_bench_fail("a revocation", fault.text);
    }
}

/* Waits until the doors, the hub and the database have nothing more to do for a change. */
static void settle(struct fleet_bench *bench, struct fleet_use *use, uint64_t sequence)
{
    fleet_wait_applied(bench, use, sequence, WAIT_S);
    fleet_wait_confirmed(bench, use, sequence, WAIT_S);
    fleet_wait_events(bench, use, 1, WAIT_S);
}

void fleet_enrol(struct fleet_bench *bench, uint32_t n)
{
    struct fleet_use use;
    const uint64_t before = fleet_sequence(bench);
    const double doors = bench->table->n;
    const double bytes = process_use_bytes(bench->port);
    fleet_use_begin(bench, &use);
    const int64_t begun_ns = fleet_table_now_ns();
    for (uint32_t i = 0; i < n; i++) {
        put_person(bench);
    }
    const double stored_s = 1e-9 * (double)(fleet_table_now_ns() - begun_ns);
    fleet_wait_applied(bench, &use, before + n, WAIT_S);
    const double applied_s = 1e-9 * (double)(fleet_table_now_ns() - begun_ns);
    settle(bench, &use, before + n);
    fleet_use_end(bench, &use);
    fleet_bench_print("enrol_people", n);
    fleet_bench_print("enrol_stored_a_second", n / stored_s);
    fleet_bench_print("enrol_at_all_doors_a_second", n / applied_s);
    fleet_bench_print("enrol_deliveries_a_second", n * doors / applied_s);
    fleet_bench_print("enrol_settled_s", 1e-9 * (double)(fleet_table_now_ns() - begun_ns));
    fleet_bench_print("enrol_bytes", (process_use_bytes(bench->port) - bytes) / (n * doors));
    fleet_use_print(&use, "enrol", n * doors);
}

/* The delays of one change, in milliseconds, of all doors. */
static void take_delays(const struct fleet_bench *bench, uint64_t sequence, int64_t begun_ns,
                        double *out)
{
    for (uint32_t i = 0; i < bench->table->n; i++) {
        out[i] = 1e-6 *
                 (double)(atomic_load(&bench->table->doors[i].applied_ns[sequence]) - begun_ns);
    }
}

/* The use counts from each revocation until everything about it is done. */
void fleet_revoke(struct fleet_bench *bench, uint32_t n)
{
    struct fleet_use use;
    const double doors = bench->table->n;
    double *delays = calloc((size_t)n * bench->table->n, sizeof *delays);
    double *confirmed = calloc(n, sizeof *confirmed), *settled = calloc(n, sizeof *settled);
    if (!delays || !confirmed || !settled) {
        fleet_bench_fail("the delays", "out of memory");
    }
    const double bytes = process_use_bytes(bench->port);
    fleet_use_begin(bench, &use);
    for (uint32_t i = 0; i < n; i++) {
        const uint64_t sequence = fleet_sequence(bench) + 1;
        const int64_t begun_ns = fleet_table_now_ns();
        fleet_revoke_one(bench);
        fleet_wait_applied(bench, &use, sequence, WAIT_S);
        fleet_wait_confirmed(bench, &use, sequence, WAIT_S);
        confirmed[i] = 1e-9 * (double)(fleet_table_now_ns() - begun_ns);
        settle(bench, &use, sequence);
        settled[i] = 1e-9 * (double)(fleet_table_now_ns() - begun_ns);
        take_delays(bench, sequence, begun_ns, delays + (size_t)i * bench->table->n);
    }
    fleet_use_end(bench, &use);
    fleet_bench_print("revoke_changes", n);
    fleet_print_spread("revoke_ms", delays, (size_t)n * bench->table->n);
    fleet_print_spread("revoke_confirmed_s", confirmed, n);
    fleet_print_spread("revoke_settled_s", settled, n);
    fleet_bench_print("revoke_bytes", (process_use_bytes(bench->port) - bytes) / (n * doors));
    fleet_use_print(&use, "revoke", n * doors);
    free(delays);
    free(confirmed);
    free(settled);
}

static int64_t stored_events(struct fleet_bench *bench)
{
    struct iso_fault fault = {.text = ""};
    PGresult *rows = NULL;
    if (hub_db_run(bench->store.db, "SELECT count(*) FROM event", NULL, &rows, &fault)) {
        fleet_bench_fail("the events", fault.text);
    }
    const int64_t n = hub_row_integer(rows, 0, 0);
    PQclear(rows);
    return n;
}

void fleet_visits(struct fleet_bench *bench, const char *prefix, uint32_t n)
{
    struct fleet_use use;
    const double all = (double)n * bench->table->n;
    char name[32];
    fleet_use_begin(bench, &use);
    fleet_wait_events(bench, &use, 1, WAIT_S);
    const int64_t before = stored_events(bench);
    const uint64_t least = atomic_load(&bench->table->visits) + n;
    fleet_use_begin(bench, &use);
    const int64_t begun_ns = fleet_table_now_ns();
    atomic_store(&bench->table->visits, least);
    /* A door's log has its visits, and the records of its joining, its lease and each change. */
    while (stored_events(bench) - before < (int64_t)all) {
        if (fleet_table_now_ns() - begun_ns > WAIT_S * INT64_C(1000000000)) {
            fleet_bench_fail("the events", "they do not arrive");
        }
        fleet_use_look(bench, &use);
        const struct timespec time = {.tv_nsec = 100000000};
        (void)nanosleep(&time, NULL);
    }
    const double took_s = 1e-9 * (double)(fleet_table_now_ns() - begun_ns);
    fleet_wait_events(bench, &use, least, WAIT_S);
    fleet_use_end(bench, &use);
    (void)snprintf(name, sizeof name, "%s_each", prefix);
    fleet_bench_print(name, n);
    (void)snprintf(name, sizeof name, "%s_a_second", prefix);
    fleet_bench_print(name, all / took_s);
    fleet_use_print(&use, prefix, all);
    (void)snprintf(name, sizeof name, "%s_surplus", prefix);
    fleet_bench_print(name, (double)(stored_events(bench) - before) - all);
}
