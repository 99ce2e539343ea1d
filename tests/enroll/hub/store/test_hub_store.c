/* The tables of the hub: keys, migrations, names, and what is in the database as plain text. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "enroll/hub/people/hub_request.h"
#include "enroll/hub/store/hub_schema.h"
#include "tests/enroll/hub/rigs/played_door.h"
#include "tests/support/scratch.h"

static void keys_are_read_as_they_were_made(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    struct hub_keys made, read;
    char path[160];
    size_t size = 0;
    (void)snprintf(path, sizeof path, "%s.other", rig->key_file);
    store_rig_fine(hub_keys_make(path, &made, &fault), &fault);
    store_rig_fine(hub_keys_read(path, &read, &fault), &fault);
    assert_memory_equal(&made, &read, sizeof made);
    assert_int_equal(hub_keys_make(path, &read, &fault), -EEXIST);

    assert_int_equal(chmod(path, 0640), 0);
    assert_int_equal(hub_keys_read(path, &read, &fault), -EACCES);
    assert_non_null(strstr(fault.text, "0640"));
    assert_int_equal(chmod(path, 0600), 0);

    uint8_t *bytes = scratch_read(path, &size);
    for (size_t at = 0; at < size; at += 7) {
        bytes[at] ^= 1;
        scratch_write(path, bytes, size);
        assert_int_equal(chmod(path, 0600), 0);
        const int error = hub_keys_read(path, &read, &fault);
        assert_true(error == -EBADMSG || error == -EPROTONOSUPPORT);
        bytes[at] ^= 1;
    }
    scratch_write(path, bytes, size - 1);
    assert_int_equal(chmod(path, 0600), 0);
    assert_int_equal(hub_keys_read(path, &read, &fault), -EBADMSG);
    free(bytes);
    assert_int_equal(unlink(path), 0);
}

static void sealed_bytes_belong_to_one_owner_and_one_use(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id anna = iso_fleet_id_of("anna", 4), ben = iso_fleet_id_of("ben", 3);
    struct iso_fleet_bytes sealed = {.bytes = NULL}, plain = {.bytes = NULL};
    const struct hub_keys *keys = &rig->store.keys;
    assert_int_equal(hub_keys_seal(keys, "template", &anna, "face", 4, &sealed), 0);
    assert_int_equal(hub_keys_open(keys, "template", &ben, sealed.bytes, sealed.size, &plain),
                     -EKEYREJECTED);
    assert_int_equal(hub_keys_open(keys, "request", &anna, sealed.bytes, sealed.size, &plain),
                     -EKEYREJECTED);
    assert_int_equal(hub_keys_open(keys, "template", &anna, sealed.bytes, 39, &plain),
                     -EKEYREJECTED);
    assert_int_equal(hub_keys_open(keys, "template", &anna, sealed.bytes, sealed.size, &plain), 0);
    assert_int_equal(plain.size, 4);
    assert_memory_equal(plain.bytes, "face", 4);
    iso_fleet_bytes_free(&plain);
    iso_fleet_bytes_free(&sealed);
}

static void migrations_keep_the_data(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    struct hub_store other = {.db = NULL};
    int64_t version = 0;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    struct played_door door;
    const struct hub_store_options options = {.conninfo = rig->postgres.conninfo,
                                              .key_file = rig->key_file,
                                              .hub_name = "hub",
                                              .actor = "anna"};
    (void)store_rig_put(rig, "anna", &zone, 1);
    played_door_join(&door, rig, "front", &zone, 1);
    store_rig_fine(played_door_send_events(&door, &rig->store, 1, 20, &fault), &fault);

    store_rig_fine(hub_schema_migrate(rig->store.db, 1, &fault), &fault);
    store_rig_fine(hub_schema_version(rig->store.db, &version, &fault), &fault);
    assert_int_equal(version, 1);
    assert_int_equal(hub_store_open(&options, &other, &fault), -EPROTONOSUPPORT);
    assert_non_null(strstr(fault.text, "migrate up"));
    store_rig_fine(hub_schema_migrate(rig->store.db, (int64_t)hub_migrations_n, &fault), &fault);
    store_rig_fine(hub_schema_check(rig->store.db, &fault), &fault);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM event"), 20);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM template"), 2);
    assert_int_equal(store_rig_zone_now(rig, &zone).place.sequence, 1);

    store_rig_fine(hub_schema_migrate(rig->store.db, 0, &fault), &fault);
    assert_int_equal(hub_store_open(&options, &other, &fault), -ENODATA);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM pg_class WHERE relnamespace = "
                                           "'public'::regnamespace"),
                     0);
    store_rig_fine(hub_schema_migrate(rig->store.db, (int64_t)hub_migrations_n, &fault), &fault);
}

static void a_newer_database_is_refused(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    store_rig_fine(hub_db_script(rig->store.db, "UPDATE isotherm_schema SET version = 99", &fault),
                   &fault);
    assert_int_equal(hub_schema_check(rig->store.db, &fault), -EPROTONOSUPPORT);
    assert_non_null(strstr(fault.text, "the database is of version 99, this program knows up to"));
    assert_int_equal(hub_schema_migrate(rig->store.db, 1, &fault), -EPROTONOSUPPORT);
    assert_int_equal(hub_schema_migrate(rig->store.db, 1000, &fault), -EINVAL);
}

static void a_failed_transaction_leaves_nothing(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    const struct iso_fleet_id zones[2] = {store_rig_zone(rig, "office"),
                                          store_rig_zone(rig, "lab")};
    const struct iso_fleet_id nowhere = iso_fleet_id_random();
    const struct iso_fleet_id both[2] = {zones[0], nowhere};
    struct iso_fleet_person person = store_rig_person("carla", 3, 2, 7);
    (void)store_rig_put(rig, "anna", zones, 2);
    const int64_t acts = store_rig_number(rig, "SELECT count(*) FROM act");
    assert_int_equal(hub_person_put(&rig->store, &person, both, 2, &fault), -ENOENT);
    /* The name of another person, in another spelling. */
    person = store_rig_person("ANNA", 3, 2, 7);
    assert_int_equal(hub_person_put(&rig->store, &person, zones, 2, &fault), -EEXIST);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM person"), 1);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM template"), 2);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM delta"), 2);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM act"), acts);
    assert_int_equal(store_rig_zone_now(rig, &zones[0]).place.sequence, 1);
}

/* Looks for bytes in a dump, in which bytea is hexadecimal. */
static bool dump_has(const char *dump, const void *bytes, size_t size)
{
    char hex[201];
    assert_true(2 * size < sizeof hex);
    (void)sodium_bin2hex(hex, sizeof hex, bytes, size);
    return strstr(dump, hex);
}

static void the_dump_has_no_template_and_no_key(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    const struct iso_fleet_person asked = store_rig_person("dora", 3, 1, 0xd1);
    uint8_t face[64], request[64];
    struct played_door door;
    memset(face, 'a', sizeof face);
    memset(request, 0xd1, sizeof request);
    const struct iso_fleet_id anna = store_rig_put(rig, "anna", &zone, 1);
    store_rig_fine(hub_person_set_credential(&rig->store, &anna, "{\"pin\": \"739184\"}", &fault),
                   &fault);
    played_door_join(&door, rig, "front", &zone, 1);
    store_rig_fine(played_door_ask(&door, &rig->store, &fault), &fault);
    store_rig_fine(played_door_request(&door, &rig->store, &asked, &fault), &fault);
    store_rig_fine(hub_snapshot_make(&rig->store, &zone, &fault), &fault);
    hub_store_close(&rig->store);

    char *dump = rig_postgres_dump(&rig->postgres);
    assert_non_null(strstr(dump, "anna")); /* it is the dump of this database */
    assert_true(dump_has(dump, door.signs.public, 32));
    assert_false(dump_has(dump, face, sizeof face));
    assert_false(dump_has(dump, request, sizeof request));
    assert_false(dump_has(dump, door.zones[0].key.bytes, 32));
    assert_null(strstr(dump, "739184"));
    assert_false(dump_has(dump, "739184", 6));
    free(dump);
    store_rig_open(rig, &rig->store);
}

static void names_are_found_in_any_spelling(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    struct hub_person person;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    const struct iso_fleet_id id = store_rig_put(rig, "Straße", &zone, 1);
    store_rig_fine(hub_person_find(&rig->store, "STRASSE", &person, &fault), &fault);
    assert_true(iso_fleet_id_is_same(&person.id, &id));
    assert_string_equal(person.name, "Straße");
    assert_int_equal(person.n_zones, 1);
    assert_string_equal(person.zone_names[0], "office");
    assert_int_equal(hub_person_find(&rig->store, "Strase", &person, &fault), -ENOENT);
    assert_int_equal(hub_person_find(&rig->store, "\xff", &person, &fault), -EINVAL);
    store_rig_fine(hub_person_rename(&rig->store, &id, "Anna", &fault), &fault);
    assert_int_equal(hub_person_find(&rig->store, "strasse", &person, &fault), -ENOENT);
    store_rig_fine(hub_person_find(&rig->store, "anna", &person, &fault), &fault);
}

static int count_person(void *context, const struct hub_person *person)
{
    (void)person;
    (*(int *)context)++;
    return 0;
}

static void people_who_must_be_seen_again(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    const struct iso_fleet_id zones[2] = {store_rig_zone(rig, "office"),
                                          store_rig_zone(rig, "lab")};
    const struct hub_person_filter unseen = {.unseen = true};
    struct iso_fleet_person person = store_rig_person("anna", 4, 2, 9);
    struct played_door door;
    int n = 0;
    (void)store_rig_put(rig, "anna", &zones[0], 1);
    (void)store_rig_put(rig, "ben", &zones[1], 1);
    played_door_join(&door, rig, "front", &zones[0], 1);
    door.algorithm = 4;
    store_rig_fine(hub_person_each(&rig->store, &unseen, count_person, &n, &fault), &fault);
    assert_int_equal(n, 0);
    store_rig_fine(played_door_ask(&door, &rig->store, &fault), &fault);
    store_rig_fine(hub_person_each(&rig->store, &unseen, count_person, &n, &fault), &fault);
    assert_int_equal(n, 1);
    store_rig_fine(hub_person_put(&rig->store, &person, zones, 1, &fault), &fault);
    n = 0;
    store_rig_fine(hub_person_each(&rig->store, &unseen, count_person, &n, &fault), &fault);
    assert_int_equal(n, 0);
    /* Templates of the other algorithm have stayed. */
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM template t JOIN person p "
                                           "ON p.id = t.person WHERE p.name = 'anna'"),
                     4);
}

static void templates_that_no_door_uses_make_room(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    struct iso_fleet_person person = store_rig_person("anna", 3, 16, 1);
    struct played_door door;
    played_door_join(&door, rig, "front", &zone, 1);
    store_rig_fine(played_door_ask(&door, &rig->store, &fault), &fault); /* algorithm 3 */
    for (uint32_t algorithm = 3; algorithm <= 5; algorithm++) {
        person = store_rig_person("anna", algorithm, 16, (uint8_t)algorithm);
        store_rig_fine(hub_person_put(&rig->store, &person, &zone, 1, &fault), &fault);
    }
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM template WHERE algorithm = 3"),
                     16);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM template WHERE algorithm = 4"), 0);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM template WHERE algorithm = 5"),
                     16);
}

static void bad_inputs_are_refused(void **state)
{
    struct store_rig *rig = *state;
    struct hub_store *store = &rig->store;
    struct iso_fault fault = {.text = ""};
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    const struct iso_fleet_id twice[2] = {zone, zone}, none = iso_fleet_id_random();
    struct iso_fleet_id id;
    char code[HUB_CODE_SIZE];
    assert_int_equal(hub_zone_add(store, "office", &id, &fault), -EEXIST);
    assert_int_equal(hub_zone_add(store, "", &id, &fault), -EINVAL);
    assert_int_equal(hub_zone_add(store, "a\nb", &id, &fault), -EINVAL);
    assert_int_equal(hub_zone_add(store, "00000000-0000-4000-8000-000000000000", &id, &fault),
                     -EINVAL);
    assert_int_equal(hub_door_add(store, "front", twice, 2, &id, code, &fault), -EINVAL);
    assert_int_equal(hub_door_add(store, "front", &none, 1, &id, code, &fault), -ENOENT);
    assert_int_equal(hub_door_add(store, "front", &zone, 0, &id, code, &fault), -EINVAL);
    assert_int_equal(hub_zone_set_policy(store, &zone, "{\"doors\": 1}", &fault), -EINVAL);
    assert_int_equal(hub_zone_lockdown(store, &none, true, &fault), -ENOENT);
    assert_int_equal(hub_person_revoke(store, &none, &fault), -ENOENT);
    assert_int_equal(hub_person_set_validity(store, &none, 9, 8, &fault), -EINVAL);
    assert_int_equal(hub_request_approve(store, &none, NULL, 0, &fault), -ENOENT);
    const struct iso_fleet_id anna = store_rig_put(rig, "anna'; DROP TABLE person; --", &zone, 1);
    assert_int_equal(hub_person_set_credential(store, &anna, "{\"cards\": 1}", &fault), -EINVAL);
    assert_int_equal(hub_person_set_zones(store, &anna, NULL, 0, &fault), -EINVAL);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM person"), 1);
}

static void a_code_is_used_once_and_in_time(void **state)
{
    struct store_rig *rig = *state;
    struct hub_store *store = &rig->store;
    struct iso_fault fault = {.text = ""};
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    struct iso_fleet_id id;
    struct played_door door = {.algorithm = 3}, other = {.algorithm = 3};
    char code[HUB_CODE_SIZE], again[HUB_CODE_SIZE], small[HUB_CODE_SIZE];
    (void)crypto_sign_keypair(door.signs.public, door.signs.secret);
    (void)crypto_sign_keypair(other.signs.public, other.signs.secret);
    store_rig_fine(hub_door_add(store, "front", &zone, 1, &id, code, &fault), &fault);
    assert_int_equal(hub_door_add(store, "front", &zone, 1, &id, again, &fault), -EEXIST);
    assert_int_equal(
        played_door_join_with(&door, store, "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA", &fault), -EACCES);
    assert_int_equal(played_door_join_with(&door, store, "AAAA", &fault), -EACCES);
    store_rig_now_s += HUB_CODE_VALID_S + 1;
    assert_int_equal(played_door_join_with(&door, store, code, &fault), -EACCES);
    store_rig_fine(hub_door_new_code(store, &id, again, &fault), &fault);
    assert_int_equal(played_door_join_with(&door, store, code, &fault), -EACCES);
    for (size_t i = 0; i < sizeof small; i++) {
        small[i] = (char)(again[i] >= 'A' && again[i] <= 'Z' ? again[i] + 32 : again[i]);
    }
    store_rig_fine(played_door_join_with(&door, store, small, &fault), &fault);
    assert_int_equal(played_door_join_with(&door, store, again, &fault), -EACCES);
    /* The same appliance may join again; another one may not. */
    store_rig_fine(hub_door_new_code(store, &id, code, &fault), &fault);
    assert_int_equal(played_door_join_with(&other, store, code, &fault), -EEXIST);
    store_rig_fine(played_door_join_with(&door, store, code, &fault), &fault);
    /* One appliance is one door. */
    store_rig_fine(hub_door_add(store, "back", &zone, 1, &id, code, &fault), &fault);
    assert_int_equal(played_door_join_with(&door, store, code, &fault), -EEXIST);
}

static void another_key_file_is_noticed(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    const struct iso_fleet_person person = store_rig_person("anna", 3, 1, 1);
    randombytes_buf(rig->store.keys.storage, sizeof rig->store.keys.storage);
    assert_int_equal(hub_person_put(&rig->store, &person, &zone, 1, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "key file"));
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM person"), 0);
}

#define TEST(NAME) cmocka_unit_test_setup_teardown(NAME, store_rig_setup, store_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(keys_are_read_as_they_were_made),
        TEST(sealed_bytes_belong_to_one_owner_and_one_use),
        TEST(migrations_keep_the_data),
        TEST(a_newer_database_is_refused),
        TEST(a_failed_transaction_leaves_nothing),
        TEST(the_dump_has_no_template_and_no_key),
        TEST(names_are_found_in_any_spelling),
        TEST(people_who_must_be_seen_again),
        TEST(templates_that_no_door_uses_make_room),
        TEST(bad_inputs_are_refused),
        TEST(a_code_is_used_once_and_in_time),
        TEST(another_key_file_is_noticed),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}
