/* People of a real LDAP directory (slapd) in a real database. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/directory/hub_ldap.h"
#include "enroll/hub/people/hub_request.h"
#include "tests/enroll/hub/directory/rig_slapd.h"
#include "tests/enroll/hub/rigs/store_rig.h"

enum { SKIPPED = 77 };

static struct rig_slapd slapd;
static struct iso_fleet_id day, night, door;

/* ---- set-up ---- */

static int start(void **state)
{
    if (!rig_slapd_start(&slapd)) {
        exit(SKIPPED);
    }
    return store_rig_start(state);
}

static int stop(void **state)
{
    rig_slapd_stop(&slapd);
    return store_rig_stop(state);
}

static int setup(void **state)
{
    const int error = store_rig_setup(state);
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    struct hub_values values = {.n = 0};
    day = store_rig_zone(rig, "day");
    night = store_rig_zone(rig, "night=shift");
    door = iso_fleet_id_random();
    hub_value_id(&values, &door);
    store_rig_fine(hub_db_run(rig->store.db,
                              "INSERT INTO door (id, name, added_s) VALUES ($1, 'Gate', 1)",
                              &values, NULL, &fault),
                   &fault);
    return error;
}

static struct hub_ldap_options options_of(void)
{
    static struct hub_ldap_group groups[2];
    groups[0] = (struct hub_ldap_group){.group = "STAFF", .zone = day};
    groups[1] = (struct hub_ldap_group){.group = "cn=night," RIG_SLAPD_BASE, .zone = night};
    return (struct hub_ldap_options){.uri = slapd.uri,
                                     .base = "ou=people," RIG_SLAPD_BASE,
                                     .filter = "(objectClass=inetOrgPerson)",
                                     .map = "disabled=employeeType,until=carLicense",
                                     .bind = RIG_SLAPD_ROOT,
                                     .password = RIG_SLAPD_PASSWORD,
                                     .groups = groups,
                                     .n_groups = 2};
}

/* One run, as the command does it. */
static int run(struct store_rig *rig, bool dry_run, bool force, struct hub_directory_counts *counts,
               struct iso_fault *fault)
{
    const struct hub_ldap_options options = options_of();
    const struct hub_directory_run how = {.source = "ldap", .dry_run = dry_run, .force = force};
    struct hub_named *named = NULL;
    size_t n = 0;
    int error = hub_ldap_read(&options, &named, &n, fault);
    error = error ? error : hub_directory_sync(&rig->store, &how, named, n, counts, fault);
    free(named);
    return error;
}

static struct hub_directory_counts import(struct store_rig *rig)
{
    struct iso_fault fault = {.text = ""};
    struct hub_directory_counts counts = {.named = 0};
    store_rig_fine(run(rig, false, false, &counts, &fault), &fault);
    return counts;
}

/* Somebody is enrolled at the door and approved. */
static struct iso_fleet_id enrol(struct store_rig *rig, const char *name,
                                 const struct iso_fleet_id *zone)
{
    struct iso_fault fault = {.text = ""};
    const struct iso_fleet_person person = store_rig_person(name, 3, 2, 7);
    store_rig_fine(hub_request_add(&rig->store, &door, &person, &fault), &fault);
    store_rig_fine(hub_request_approve(&rig->store, &person.id, zone, 1, &fault), &fault);
    return person.id;
}

static struct hub_person person_of(struct store_rig *rig, const struct iso_fleet_id *id)
{
    struct iso_fault fault = {.text = ""};
    struct hub_person person;
    char text[ISO_FLEET_ID_TEXT_SIZE];
    store_rig_fine(hub_person_find(&rig->store, iso_fleet_id_text(id, text), &person, &fault),
                   &fault);
    return person;
}

static void expect_zones(struct store_rig *rig, const struct iso_fleet_id *id, size_t n,
                         const char *const names[])
{
    const struct hub_person person = person_of(rig, id);
    assert_int_equal(person.n_zones, n);
    for (size_t i = 0; i < n; i++) {
        assert_string_equal(person.zone_names[i], names[i]);
    }
}

/* ---- the life of people ---- */

static void a_person_is_named_enrolled_changed_and_removed(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id other = store_rig_put(rig, "Other", &day, 1);
    const uint64_t other_revision = person_of(rig, &other).revision;
    rig_slapd_add(&slapd, "ada", "Ada Byron");
    rig_slapd_join(&slapd, "staff", "ada");
    rig_slapd_join(&slapd, "night", "ada");
    struct hub_directory_counts counts = import(rig);
    assert_int_equal(counts.named, 1);
    assert_int_equal(counts.added, 1);
    /* She has no face yet: no door gets anything. */
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM person"), 1);
    assert_int_equal(store_rig_number(rig, "SELECT sum(sequence)::bigint FROM zone"), 1);
    store_rig_now_s += 60;
    const struct iso_fleet_id ada = enrol(rig, "ada BYRON", &day);
    counts = import(rig);
    assert_int_equal(counts.linked, 1);
    expect_zones(rig, &ada, 2, (const char *const[]){"day", "night=shift"});
    assert_string_equal(person_of(rig, &ada).name, "Ada Byron");
    /* A run without changes changes nothing. */
    const uint64_t revision = person_of(rig, &ada).revision;
    counts = import(rig);
    assert_int_equal(counts.added + counts.changed + counts.linked + counts.removed, 0);
    assert_int_equal(person_of(rig, &ada).revision, revision);
    /* Marriage, another group, an end. */
    rig_slapd_set(&slapd, "ada", "cn", "Ada Lovelace");
    rig_slapd_set(&slapd, "ada", "carLicense", "20261231235959Z");
    rig_slapd_leave(&slapd, "night", "ada");
    counts = import(rig);
    assert_int_equal(counts.changed, 1);
    expect_zones(rig, &ada, 1, (const char *const[]){"day"});
    assert_string_equal(person_of(rig, &ada).name, "Ada Lovelace");
    assert_int_equal(person_of(rig, &ada).valid_until_s, 1798761599);
    rig_slapd_delete(&slapd, "ada");
    struct iso_fault fault = {.text = ""};
    store_rig_fine(run(rig, false, true, &counts, &fault), &fault);
    assert_int_equal(counts.removed, 1);
    expect_zones(rig, &ada, 0, NULL);
    assert_int_equal(person_of(rig, &ada).templates, 2);
    /* Nobody else was touched. */
    assert_int_equal(person_of(rig, &other).revision, other_revision);
}

static void who_is_disabled_loses_every_zone_and_gets_the_own_ones_back(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    struct hub_directory_counts counts;
    rig_slapd_add(&slapd, "ben", "Ben");
    rig_slapd_join(&slapd, "staff", "ben");
    (void)import(rig);
    const struct iso_fleet_id ben = enrol(rig, "Ben", &night);
    (void)import(rig);
    /* The zone that another gave stays. */
    expect_zones(rig, &ben, 2, (const char *const[]){"day", "night=shift"});
    rig_slapd_set(&slapd, "ben", "employeeType", "TRUE");
    store_rig_fine(run(rig, false, true, &counts, &fault), &fault);
    assert_int_equal(counts.removed, 1);
    expect_zones(rig, &ben, 0, NULL);
    /* Somebody lets him in by hand; the next run ends that. */
    store_rig_fine(hub_person_set_zones(&rig->store, &ben, &night, 1, &fault), &fault);
    (void)import(rig);
    expect_zones(rig, &ben, 0, NULL);
    rig_slapd_set(&slapd, "ben", "employeeType", NULL);
    (void)import(rig);
    expect_zones(rig, &ben, 1, (const char *const[]){"day"});
    rig_slapd_delete(&slapd, "ben");
}

static void somebody_who_was_there_before_is_linked_by_hand_alone(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    const struct iso_fleet_id cid = enrol(rig, "Cid", &night);
    store_rig_now_s += 60;
    rig_slapd_add(&slapd, "cid", "Cid");
    rig_slapd_join(&slapd, "staff", "cid");
    assert_int_equal(import(rig).linked, 0);
    assert_int_equal(import(rig).linked, 0);
    expect_zones(rig, &cid, 1, (const char *const[]){"night=shift"});
    assert_int_equal(hub_directory_link(&rig->store, "ldap", "unknown", &cid, &fault), -ENOENT);
    PGresult *rows = NULL;
    store_rig_fine(hub_db_run(rig->store.db, "SELECT external FROM directory", NULL, &rows, &fault),
                   &fault);
    store_rig_fine(hub_directory_link(&rig->store, "ldap", hub_row_text(rows, 0, 0), &cid, &fault),
                   &fault);
    assert_int_equal(
        hub_directory_link(&rig->store, "ldap", hub_row_text(rows, 0, 0), &cid, &fault), -EEXIST);
    PQclear(rows);
    expect_zones(rig, &cid, 2, (const char *const[]){"day", "night=shift"});
    rig_slapd_delete(&slapd, "cid");
}

static void add_many(int n)
{
    for (int i = 0; i < n; i++) {
        char uid[16], name[32];
        (void)snprintf(uid, sizeof uid, "u%d", i);
        (void)snprintf(name, sizeof name, "Person %d", i);
        rig_slapd_add(&slapd, uid, name);
        rig_slapd_join(&slapd, "staff", uid);
    }
}

static void delete_many(int from, int to)
{
    for (int i = from; i < to; i++) {
        char uid[16];
        (void)snprintf(uid, sizeof uid, "u%d", i);
        rig_slapd_delete(&slapd, uid);
    }
}

static void a_run_that_takes_too_many_zones_stops(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    struct hub_directory_counts counts = {.named = 0};
    add_many(10);
    assert_int_equal(import(rig).added, 10);
    delete_many(0, 2);
    assert_int_equal(import(rig).removed, 2); /* 20 % of ten */
    delete_many(2, 4);
    assert_int_equal(run(rig, false, false, &counts, &fault), -EPERM); /* 25 % of eight */
    assert_non_null(strstr(fault.text, "2 of 8 people"));
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM directory WHERE named"), 8);
    store_rig_fine(run(rig, true, true, &counts, &fault), &fault);
    assert_int_equal(counts.removed, 2);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM directory WHERE named"), 8);
    store_rig_fine(run(rig, false, true, &counts, &fault), &fault);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM directory WHERE named"), 6);
    delete_many(4, 10);
    /* An empty answer is no reason to lock everybody out. */
    assert_int_equal(run(rig, false, false, &counts, &fault), -EPERM);
}

static void one_bad_name_does_not_stop_the_others(void **state)
{
    struct store_rig *rig = *state;
    (void)store_rig_put(rig, "Dora", &day, 1);
    rig_slapd_add(&slapd, "u0", "Dolly");
    rig_slapd_add(&slapd, "u1", "Emil");
    (void)import(rig);
    store_rig_now_s += 1;
    const struct iso_fleet_id dolly = enrol(rig, "Dolly", &day);
    (void)import(rig);
    rig_slapd_set(&slapd, "u0", "cn", "Dora");
    rig_slapd_set(&slapd, "u1", "cn", "Emilia");
    const struct hub_directory_counts counts = import(rig);
    assert_int_equal(counts.failed, 1);
    assert_int_equal(counts.changed, 1);
    assert_string_equal(person_of(rig, &dolly).name, "Dolly");
    delete_many(0, 2);
}

/* ---- the server ---- */

static void more_people_than_a_page_are_read(void **state)
{
    struct store_rig *rig = *state;
    /* The server gives at most 600 in one answer, and 500 in a page. */
    for (int i = 0; i < 1100; i++) {
        char uid[16], name[32];
        (void)snprintf(uid, sizeof uid, "u%d", i);
        (void)snprintf(name, sizeof name, "Person %d", i);
        rig_slapd_add(&slapd, uid, name);
    }
    assert_int_equal(import(rig).added, 1100);
    delete_many(0, 1100);
}

static int read_with(const struct hub_ldap_options *options, struct iso_fault *fault)
{
    struct hub_named *named = NULL;
    size_t n = 0;
    const int error = hub_ldap_read(options, &named, &n, fault);
    free(named);
    return error;
}

static void what_cannot_be_read_whole_is_an_error(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct hub_ldap_options options = options_of();
    (void)state;
    rig_slapd_add(&slapd, "u0", "Frida");
    options.password = "wrong";
    assert_int_equal(read_with(&options, &fault), -EACCES);
    options.password = "";
    assert_int_equal(read_with(&options, &fault), -EINVAL);
    options = options_of();
    options.filter = "(cn=";
    assert_int_equal(read_with(&options, &fault), -EINVAL);
    options = options_of();
    options.base = "ou=nobody," RIG_SLAPD_BASE;
    assert_int_equal(read_with(&options, &fault), -EIO);
    options = options_of();
    options.map = "name=telephoneNumber";
    assert_int_equal(read_with(&options, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "uid=u0,ou=people"));
    options = options_of();
    rig_slapd_set(&slapd, "u0", "carLicense", "some day");
    assert_int_equal(read_with(&options, &fault), -EBADMSG);
    options.uri = "ldap://127.0.0.1:1";
    assert_int_equal(read_with(&options, &fault), -ENOTCONN);
    options.uri = "nonsense";
    assert_int_equal(read_with(&options, &fault), -EINVAL);
    delete_many(0, 1);
}

static void tls_is_checked(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct hub_ldap_options options = options_of();
    (void)state;
    options.uri = slapd.tls_uri;
    assert_int_equal(read_with(&options, &fault), -ENOTCONN);
    options.ca_file = slapd.certificate;
    store_rig_fine(read_with(&options, &fault), &fault);
    /* With certificates also a connection to this machine begins TLS. */
    options.uri = slapd.uri;
    store_rig_fine(read_with(&options, &fault), &fault);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_person_is_named_enrolled_changed_and_removed, setup,
                                        store_rig_teardown),
        cmocka_unit_test_setup_teardown(who_is_disabled_loses_every_zone_and_gets_the_own_ones_back,
                                        setup, store_rig_teardown),
        cmocka_unit_test_setup_teardown(somebody_who_was_there_before_is_linked_by_hand_alone,
                                        setup, store_rig_teardown),
        cmocka_unit_test_setup_teardown(a_run_that_takes_too_many_zones_stops, setup,
                                        store_rig_teardown),
        cmocka_unit_test_setup_teardown(one_bad_name_does_not_stop_the_others, setup,
                                        store_rig_teardown),
        cmocka_unit_test_setup_teardown(more_people_than_a_page_are_read, setup,
                                        store_rig_teardown),
        cmocka_unit_test(what_cannot_be_read_whole_is_an_error),
        cmocka_unit_test(tls_is_checked),
    };
    return cmocka_run_group_tests(tests, start, stop);
}
