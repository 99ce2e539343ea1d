/* The figures of a fleet, read as Prometheus reads them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "enroll/hub/answer/hub_outbox.h"
#include "enroll/hub/metrics/hub_metrics.h"
#include "enroll/hub/outlet/hub_outlet.h"
#include "tests/enroll/hub/rigs/store_rig.h"
#include "tests/support/memory_text.h"
#include "tests/support/programs/prometheus_text.h"
#include "tests/support/scratch.h"

static const char file[] = "/tmp/isotherm-test-metrics.prom";

static char *text_of(struct store_rig *rig)
{
    struct iso_fault fault = {.text = ""};
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    store_rig_fine(hub_metrics_write(&rig->store, out, &fault), &fault);
    assert_int_equal(fclose(out), 0);
    return memory_text(text);
}

/* The value of a line that begins with this name and these labels; fails if there is none. */
static long long value_of(const char *text, const char *series)
{
    char line[256];
    const int length = snprintf(line, sizeof line, "\n%s ", series);
    assert_in_range(length, 1, sizeof line - 1);
    const char *at = strstr(text, line);
    if (!at) {
        fail_msg("there is no %s", series);
        return -1;
    }
    return strtoll(at + strlen(line), NULL, 10);
}

static void change(struct store_rig *rig, const char *sql)
{
    struct iso_fault fault = {.text = ""};
    store_rig_fine(hub_db_script(rig->store.db, sql, &fault), &fault);
}

/* Two doors of a zone with two people; one door has reported what the zone has, the other one not.
 */
static struct iso_fleet_id make_fleet(struct store_rig *rig)
{
    const struct iso_fleet_id zone = store_rig_zone(rig, "a \"b\" \\c");
    (void)store_rig_put(rig, "Ada", &zone, 1);
    (void)store_rig_put(rig, "Ben", &zone, 1);
    change(rig, "INSERT INTO door (id, name, added_s, joined_s, online, reported_s, acked) VALUES "
                "('00000000-0000-4000-8000-000000000001', 'Gate', 1, 2, true, 1234, 40), "
                "('00000000-0000-4000-8000-000000000002', 'Yard', 1, 2, false, 0, 2), "
                "('00000000-0000-4000-8000-000000000003', 'New', 1, 0, false, 0, 0);"
                "INSERT INTO door_zone SELECT d.id, z.id, 0 FROM door d, zone z;"
                "INSERT INTO door_place SELECT d.id, z.id, z.epoch, z.sequence, z.digest "
                "FROM door d, zone z WHERE d.name = 'Gate'");
    return zone;
}

static void figures_are_those_of_the_database(void **state)
{
    struct store_rig *rig = *state;
    char series[256], id[ISO_FLEET_ID_TEXT_SIZE];
    const struct iso_fleet_id zone = make_fleet(rig);
    char *text = text_of(rig);
    assert_int_equal(value_of(text, "isotherm_fleet_doors_joined"), 2);
    assert_int_equal(value_of(text, "isotherm_fleet_doors_online"), 1);
    assert_int_equal(value_of(text, "isotherm_fleet_events_total"), 42);
    assert_true(value_of(text, "isotherm_fleet_database_bytes") > 100000);
    assert_int_equal(value_of(text, "isotherm_fleet_door_reported_seconds{door=\"00000000-0000-"
                                    "4000-8000-000000000001\",name=\"Gate\"}"),
                     1234);
    static const struct {
        const char *name;
        long long value;
    } zones[] = {{"doors", 2},           {"doors_behind", 1}, {"people", 2}, {"deltas_total", 2},
                 {"published_total", 0}, {"lockdown", 0},     {"behind", 0}, {"epoch", 1}};
    for (size_t i = 0; i < sizeof zones / sizeof *zones; i++) {
        (void)snprintf(series, sizeof series,
                       "isotherm_fleet_zone_%s{zone=\"%s\",name=\"a \\\"b\\\" \\\\c\"}",
                       zones[i].name, iso_fleet_id_text(&zone, id));
        assert_int_equal(value_of(text, series), zones[i].value);
    }
    assert_null(strstr(text, "\"New\""));
    free(text);
}

static void the_leader_is_seen_by_another_process(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    struct hub_store other;
    bool is_leader = false;
    store_rig_open(rig, &other);
    char *text = text_of(rig);
    assert_int_equal(value_of(text, "isotherm_fleet_leader"), 0);
    free(text);
    store_rig_fine(hub_leader_try(&other, &is_leader, &fault), &fault);
    assert_true(is_leader);
    text = text_of(rig);
    assert_int_equal(value_of(text, "isotherm_fleet_leader"), 1);
    free(text);
    hub_store_close(&other);
}

static void outlets_and_directories_are_counted(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    char secret[HUB_OUTLET_SECRET_SIZE];
    const struct hub_outlet_options options = {.name = "siem",
                                               .address = "udp://127.0.0.1",
                                               .kind = HUB_OUTLET_SYSLOG,
                                               .from_beginning = true};
    (void)make_fleet(rig);
    store_rig_fine(hub_outlet_add(&rig->store, &options, secret, &fault), &fault);
    change(rig,
           "UPDATE outlet SET failures = 3, stopped = true, delivered = 9;"
           "INSERT INTO directory (id, source, external, name, folded, active, named, added_s) "
           "VALUES (gen_random_uuid(), 'ldap', '1', 'Cid', 'cid', true, true, 1), "
           "(gen_random_uuid(), 'ldap', '2', 'Eve', 'eve', false, true, 1)");
    char *text = text_of(rig);
    assert_int_equal(value_of(text, "isotherm_fleet_outlet_waiting{outlet=\"siem\"}"), 42);
    assert_int_equal(value_of(text, "isotherm_fleet_outlet_failures{outlet=\"siem\"}"), 3);
    assert_int_equal(value_of(text, "isotherm_fleet_outlet_stopped{outlet=\"siem\"}"), 1);
    assert_int_equal(value_of(text, "isotherm_fleet_outlet_delivered_total{outlet=\"siem\"}"), 9);
    assert_int_equal(value_of(text, "isotherm_fleet_directory_people{state=\"missing\"}"), 1);
    assert_int_equal(value_of(text, "isotherm_fleet_directory_people{state=\"disabled\"}"), 1);
    assert_int_equal(value_of(text, "isotherm_fleet_directory_people{state=\"enrolled\"}"), 0);
    free(text);
}

static void the_text_has_the_format(void **state)
{
    struct store_rig *rig = *state;
    (void)make_fleet(rig);
    char *text = text_of(rig);
    prometheus_text_check(text);
    free(text);
}

static void a_file_takes_the_place_of_the_old_one(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    struct stat before, after;
    scratch_write_text(file, "old\n");
    assert_int_equal(stat(file, &before), 0);
    store_rig_fine(hub_metrics_file(&rig->store, file, &fault), &fault);
    assert_int_equal(stat(file, &after), 0);
    assert_int_equal(after.st_mode & 0777, 0644);
    assert_true(after.st_ino != before.st_ino);
    char *text = scratch_read_text(file);
    assert_non_null(strstr(text, "\nisotherm_fleet_doors_joined 0\n"));
    /* Without a database the old file stays, and none is left beside it. */
    rig_postgres_down(&rig->postgres);
    assert_int_equal(hub_metrics_file(&rig->store, file, &fault), -ENOTCONN);
    rig_postgres_up(&rig->postgres);
    char *again = scratch_read_text(file);
    assert_string_equal(again, text);
    assert_false(scratch_exists("/tmp/isotherm-test-metrics.prom.new"));
    assert_int_equal(hub_metrics_file(&rig->store, "/nowhere/x.prom", &fault), -ENOENT);
    free(text);
    free(again);
    (void)unlink(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(figures_are_those_of_the_database, store_rig_setup,
                                        store_rig_teardown),
        cmocka_unit_test_setup_teardown(the_leader_is_seen_by_another_process, store_rig_setup,
                                        store_rig_teardown),
        cmocka_unit_test_setup_teardown(outlets_and_directories_are_counted, store_rig_setup,
                                        store_rig_teardown),
        cmocka_unit_test_setup_teardown(the_text_has_the_format, store_rig_setup,
                                        store_rig_teardown),
        cmocka_unit_test_setup_teardown(a_file_takes_the_place_of_the_old_one, store_rig_setup,
                                        store_rig_teardown),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}
