/* isotherm-hub, the program itself, against a PostgreSQL of its own. */
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

#include "enroll/hub/command/hub_command.h"
#include "enroll/hub/people/hub_request.h"
#include "tests/enroll/hub/rigs/played_door.h"
#include "tests/enroll/hub/update/bundle_rig.h"
#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

#define PROGRAM ISOTHERM_BINARY_DIR "/enroll/hub/command/isotherm-hub"

enum { WORDS_MAX = 12, SKIPPED = 77 };

static struct rig_postgres postgres;
static char config[160], folder[160];

static int start(void **state)
{
    char text[600];
    (void)scratch_setup(state);
    if (!rig_postgres_start(&postgres)) {
        (void)scratch_teardown(state);
        exit(SKIPPED);
    }
    (void)snprintf(config, sizeof config, "%s", scratch_path(*state, "hub.conf"));
    (void)snprintf(folder, sizeof folder, "%s", scratch_path(*state, "hub"));
    (void)snprintf(text, sizeof text,
                   "[database]\nconninfo = %s\n[hub]\nname = head office\nfolder = %s\n"
                   "host = hub.example\n[broker]\nhub_host = localhost\n",
                   postgres.conninfo, folder);
    scratch_write_text(config, text);
    return 0;
}

static int stop(void **state)
{
    rig_postgres_stop(&postgres);
    return scratch_teardown(state);
}

/* Runs the program with words between blanks, and expects an exit code. Returns what it has printed
 * to standard output, or to standard error after a failure; to be freed. */
static char *hub(int exit, const char *words)
{
    char text[400], *rest = NULL;
    const char *argv[WORDS_MAX + 4] = {PROGRAM};
    struct run run;
    size_t n = 1;
    (void)snprintf(text, sizeof text, "%s", words);
    for (char *word = strtok_r(text, " ", &rest); word; word = strtok_r(NULL, " ", &rest)) {
        assert_true(n < WORDS_MAX);
        argv[n++] = word;
    }
    argv[n++] = "--config";
    argv[n] = config;
    run_start(&run, argv);
    run_finish(&run);
    run_expect(&run, exit);
    char *said = strdup(exit > 1 || (exit == 1 && run.err_size > 0) ? run.err : run.out);
    assert_non_null(said);
    run_free(&run);
    return said;
}

static void expect(int exit, const char *words, const char *part)
{
    char *said = hub(exit, words);
    if (!strstr(said, part)) {
        fail_msg("%s: said: %s", words, said);
    }
    /* A fault is one line. */
    if (exit > 1) {
        assert_ptr_equal(strchr(said, '\n'), said + strlen(said) - 1);
    }
    free(said);
}

static void init_makes_keys_and_tables_once(void **state)
{
    struct stat s;
    char key_file[200];
    (void)state;
    (void)snprintf(key_file, sizeof key_file, "%s/hub.keys", folder);
    expect(3, "zone list", "hub.keys");
    expect(0, "init", "made the keys");
    assert_int_equal(stat(key_file, &s), 0);
    assert_int_equal(s.st_mode & 07777, 0600);
    char *again = hub(0, "init");
    assert_null(strstr(again, "made the keys"));
    free(again);
    /* The keys of a database with tables are never made anew. */
    char other[210];
    (void)snprintf(other, sizeof other, "%s.away", key_file);
    assert_int_equal(rename(key_file, other), 0);
    expect(1, "init", "copy the key file");
    assert_int_equal(rename(other, key_file), 0);
    assert_int_equal(chmod(key_file, 0644), 0);
    expect(1, "zone list", "0644");
    assert_int_equal(chmod(key_file, 0600), 0);
}

/* Joins a door with the address that the program has printed. */
static void join(struct played_door *door, struct hub_store *store, const char *address)
{
    struct iso_fault fault = {.text = ""};
    char code[HUB_CODE_SIZE];
    const char *at = strstr(address, "&code=");
    assert_non_null(at);
    (void)snprintf(code, sizeof code, "%s", at + strlen("&code="));
    *door = (struct played_door){.algorithm = 3};
    (void)crypto_sign_keypair(door->signs.public, door->signs.secret);
    (void)crypto_box_keypair(door->receives.public, door->receives.secret);
    store_rig_fine(played_door_join_with(door, store, code, &fault), &fault);
}

static void open_store(struct hub_store *store)
{
    struct iso_fault fault = {.text = ""};
    char key_file[200];
    (void)snprintf(key_file, sizeof key_file, "%s/hub.keys", folder);
    const struct hub_store_options options = {.conninfo = postgres.conninfo,
                                              .key_file = key_file,
                                              .hub_name = "head office",
                                              .actor = "test"};
    store_rig_fine(hub_store_open(&options, store, &fault), &fault);
}

/* A door in a lockdown, with events, that is expelled. */
static void leave(struct played_door *door, struct hub_store *store)
{
    struct iso_fault fault = {.text = ""};
    /* A lockdown says who has not confirmed it. */
    store_rig_fine(played_door_ask(door, store, &fault), &fault);
    expect(1, "lockdown on --wait 0", "not confirmed: front, online");
    played_door_fetch(door, store);
    store_rig_fine(played_door_ask(door, store, &fault), &fault);
    assert_true(door->zones[0].lockdown);
    free(hub(0, "lockdown on office"));

    store_rig_fine(played_door_send_events(door, store, 1, 5, &fault), &fault);
    expect(0, "event list --door front --count 1", "front 5 {");
    expect(0, "act list", "person-revoke anna");
    free(hub(0, "door expel front"));
    expect(1, "door expel front", "is expelled");
    expect(1, "door code front", "is expelled");
    expect(0, "door list --all", "expelled");
}

static void a_fleet_is_run_by_commands(void **state)
{
    static struct played_door door;
    struct iso_fault fault = {.text = ""};
    struct hub_store store;
    const struct iso_fleet_person anna = store_rig_person("anna", 3, 2, 1);
    const struct iso_fleet_person ben = store_rig_person("ben", 3, 2, 2);
    (void)state;
    open_store(&store);
    free(hub(0, "zone add office"));
    free(hub(0, "zone add lab"));
    expect(1, "zone add lab", "there is a zone of this name");
    free(hub(0, "zone set lab --lease 60 --approve auto --local-people yes"));
    expect(0, "zone list", "lease 60 s  local people yes  approve auto");

    char *address = hub(0, "door add front --zone office --zone lab");
    assert_int_equal(strncmp(address, "isotherm://hub.example:8443/?ca=", 32), 0);
    assert_int_equal(strlen(address), 32 + 64 + strlen("&code=") + 32 + 1);
    expect(0, "door list", "not joined");
    join(&door, &store, address);
    free(address);
    store_rig_fine(played_door_ask(&door, &store, &fault), &fault);
    expect(0, "door show front", "online");

    /* A request becomes a person, who is changed and revoked. */
    store_rig_fine(played_door_request(&door, &store, &anna, &fault), &fault);
    store_rig_fine(played_door_request(&door, &store, &ben, &fault), &fault);
    expect(0, "request list", "anna");
    free(hub(0, "request approve anna --zone office --zone lab"));
    free(hub(0, "request reject ben"));
    expect(3, "request approve ben", "there is no such request");
    expect(0, "request list --all", "rejected");
    expect(1, "person limit ANNA --until 2099-12-31 --wait 0", "not confirmed: front");
    expect(0, "person list --zone lab --search AN", "2099-12-31");
    free(hub(0, "person offline anna yes"));
    expect(0, "person show anna", "offline-ok");
    free(hub(1, "person move anna --zone lab --wait 0"));
    played_door_fetch(&door, &store);
    store_rig_fine(played_door_ask(&door, &store, &fault), &fault);
    assert_int_equal(door.n_people, 1);
    free(hub(1, "person revoke anna --wait 0"));
    expect(3, "person show anna", "there is no such person");
    played_door_fetch(&door, &store);
    assert_int_equal(door.n_people, 0);

    leave(&door, &store);
    hub_store_close(&store);
}

/* The door of a_fleet_is_run_by_commands was expelled; another one is updated. */
static void a_zone_is_updated_by_commands(void **state)
{
    static struct played_door door;
    struct iso_fault fault = {.text = ""};
    struct hub_store store;
    char words[200], *address;
    (void)snprintf(words, sizeof words, "update add %s", scratch_path(*state, "next.raucb"));
    expect(3, words, "next.raucb");
    bundle_rig_write(scratch_path(*state, "next.raucb"), bundle_rig_manifest("1.2", "isotherm-pc"),
                     3 << 20, 1);
    expect(0, words, "version 1.2 for isotherm-pc, 3.0 MiB");
    expect(1, words, "is here already");
    expect(2, "update roll 1.2", "--zone ZONE");
    expect(3, "update roll 1.3 --zone lab", "no update of version 1.3");
    expect(4, "update roll 1.2 --zone lab", "no door of zone lab has joined");
    open_store(&store);
    address = hub(0, "door add back --zone lab");
    join(&door, &store, address);
    free(address);
    free(hub(0, "update roll 1.2 --zone lab --first 1 --stop-after 0 --wait 60"));
    expect(1, "update roll 1.2 --zone lab", "on the way to version 1.2");
    expect(1, "update remove 1.2", "stop it first");
    expect(0, "update show lab", "waiting");
    door.health = "{\"update-state\":\"idle\",\"image-version\":\"1.1\","
                  "\"image-board\":\"isotherm-pc\"}";
    store_rig_fine(played_door_ask(&door, &store, &fault), &fault);
    assert_true(door.is_ordered);
    expect(0, "update list", "1 doors: 0 healthy, 0 failed, 1 at work, 0 waiting, 0 unable");
    expect(0, "update show lab", "told");
    free(hub(0, "update stop lab"));
    expect(0, "update list", "zone lab: stopped (by ");
    free(hub(0, "update resume lab"));
    expect(1, "update resume lab", "no rollout that was stopped");
    free(hub(0, "update stop lab"));
    free(hub(0, "update remove 1.2"));
    expect(3, "update remove 1.2", "no update of version 1.2");
    expect(3, "update show office", "has had no rollout");
    expect(0, "act list", "update-roll lab");
    hub_store_close(&store);
}

static void the_broker_is_configured(void **state)
{
    char words[200];
    (void)snprintf(words, sizeof words, "broker-config --output %s",
                   scratch_path(*state, "broker"));
    scratch_mkdir(scratch_path(*state, "broker"));
    free(hub(0, words));
    char *text = scratch_read_text(scratch_path(*state, "broker/mosquitto.conf"));
    assert_non_null(strstr(text, "8884"));
    free(text);
    expect(0, "serve --help", "--door-broker");
    free(hub(2, "serve --sing"));
}

static void wrong_words_are_one_line(void **state)
{
    (void)state;
    expect(2, "sing", "there is no such command");
    expect(2, "zone add", "usage: isotherm-hub zone add NAME");
    expect(2, "zone list --door x", "has no option --door");
    expect(2, "zone set lab --lease soon", "soon");
    expect(2, "door add x", "1 to 8 zones");
    expect(3, "door add x --zone nowhere", "nowhere");
    expect(2, "person limit anna --until 2026-02-30", "2026-02-30");
    expect(2, "lockdown maybe", "neither on nor off");
    expect(1, "recover lab", "no door knows more");
    expect(1, "migrate down 0", "--all");
    expect(2, "migrate up 99", "99");
    expect(0, "migrate down 1", "version 1");
    expect(4, "zone list", "migrate up");
    expect(0, "migrate up", "version");
    expect(0, "zone list", "office");
}

static void a_wrong_configuration_is_one_line(void **state)
{
    static const char *const texts[] = {"[hub]\nport = 0\n", "[hub]\nprot = 1\n", "[hub]\nport\n",
                                        "[hub]\nhome_assistant = maybe\n"};
    struct iso_fault fault;
    struct hub_config read;
    const char *path = scratch_path(*state, "wrong.conf");
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        scratch_write_text(path, texts[i]);
        assert_true(hub_config_read(path, false, &read, &fault) < 0);
        assert_null(strchr(fault.text, '\n'));
        assert_non_null(strstr(fault.text, "wrong.conf"));
    }
    assert_int_equal(hub_config_read("/nowhere/hub.conf", false, &read, &fault), -ENOENT);
    store_rig_fine(hub_config_read("/nowhere/hub.conf", true, &read, &fault), &fault);
    scratch_write_text(path, "");
    store_rig_fine(hub_config_read(path, false, &read, &fault), &fault);
    assert_string_equal(read.key_file, "/var/lib/isotherm-hub/hub.keys");
}

static void every_command_and_option_stands_in_the_manual(void **state)
{
    const struct hub_command *const tables[] = {
        hub_setup_commands,  hub_serve_commands,   hub_zone_commands, hub_door_commands,
        hub_person_commands, hub_request_commands, hub_event_commands};
    char *manual = scratch_read_text(ISOTHERM_SOURCE_DIR "/enroll/man/isotherm-hub.8");
    int n = 0;
    (void)state;
    for (size_t t = 0; t < sizeof tables / sizeof *tables; t++) {
        for (const struct hub_command *c = tables[t]; c->words; c++, n++) {
            char item[64];
            (void)snprintf(item, sizeof item, "\n.It Ic %s", c->words);
            char *at = strstr(manual, item);
            if (!at) {
                fail_msg("isotherm-hub(8) does not have %s", c->words);
            }
            const size_t length = strcspn(at + 1, "\n");
            for (const char *o = strstr(c->synopsis, "--"); o; o = strstr(o + 2, "--")) {
                (void)snprintf(item, sizeof item, "Fl Fl %.*s", (int)strcspn(o + 2, " ]"), o + 2);
                const char *found = strstr(at, item);
                if (!found || found > at + 1 + length) {
                    fail_msg("isotherm-hub(8): %s: %s is missing", c->words, item);
                }
            }
        }
    }
    assert_true(n > 25);
    free(manual);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(init_makes_keys_and_tables_once),
        cmocka_unit_test(a_fleet_is_run_by_commands),
        cmocka_unit_test(a_zone_is_updated_by_commands),
        cmocka_unit_test(the_broker_is_configured),
        cmocka_unit_test(wrong_words_are_one_line),
        cmocka_unit_test(a_wrong_configuration_is_one_line),
        cmocka_unit_test(every_command_and_option_stands_in_the_manual),
    };
    return cmocka_run_group_tests(tests, start, stop);
}
