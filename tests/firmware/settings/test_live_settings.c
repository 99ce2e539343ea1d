/* Which settings can be changed while the daemon runs, the file of the changes, and what holds
 * after a restart. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/settings/live_settings.h"
#include "tests/firmware/rigs/stores.h"
#include "tests/support/scratch.h"

struct world {
    struct iso_config config;
    struct iso_live_settings settings;
    char path[256];
    char warned[1024];
};

static struct world world;

static void warn(void *context, const char *text)
{
    struct world *w = context;
    const size_t n = strlen(w->warned);
    (void)snprintf(w->warned + n, sizeof w->warned - n, "%s\n", text);
}

/* The daemon starts with this configuration file. */
static int start(const char *directory, const char *text, struct iso_fault *fault)
{
    assert_int_equal(iso_config_parse("test", text, &world.config, fault), 0);
    (void)snprintf(world.path, sizeof world.path, "%s", scratch_path(directory, "settings"));
    world.warned[0] = '\0';
    iso_live_settings_init(&world.settings, &world.config, world.path, stores_ring(directory));
    return iso_live_settings_load(&world.settings, warn, &world, fault);
}

static void change(const char *section, const char *key, const char *value)
{
    struct iso_live_change made;
    struct iso_fault fault = {.text = ""};
    if (iso_live_settings_check(&world.settings, section, key, value, &made, &fault) ||
        iso_live_settings_make(&world.settings, &made, &fault)) {
        fail_msg("%s.%s: %s", section, key, fault.text);
    }
}

static void expect_refusal(const char *section, const char *key, const char *value,
                           const char *text)
{
    struct iso_live_change made = {.before = "as before"};
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_live_settings_check(&world.settings, section, key, value, &made, &fault),
                     -EINVAL);
    assert_string_equal(fault.text, text);
    assert_string_equal(made.before, "as before");
}

/* ---- keys ---- */

static void keys_that_need_a_restart_are_not_changed(void **state)
{
    static const char *const fixed[][2] = {{"sensor", "backend"},
                                           {"sensor", "distance_max_mm"},
                                           {"sensor", "stale_ms"},
                                           {"door", "backend"},
                                           {"door", "fail"},
                                           {"door", "relay_pulse_ms"},
                                           {"door", "cards"},
                                           {"gallery", "path"},
                                           {"gallery", "capacity"},
                                           {"seal", "key"},
                                           {"recognition", "intensity"},
                                           {"match", "method"},
                                           {"lockout", "path"},
                                           {"log", "path"},
                                           {"log", "max_mib"},
                                           {"bus", "address"},
                                           {"process", "confine"},
                                           {"model", "head"}};
    (void)state;
    for (size_t i = 0; i < sizeof fixed / sizeof *fixed; i++) {
        assert_null(iso_live_key_find(fixed[i][0], fixed[i][1]));
    }
    assert_null(iso_live_key_find("decision", "leve"));
    assert_null(iso_live_key_find("decision", ""));
    assert_null(iso_live_key_find("enroll", "level"));
    assert_int_equal(iso_live_keys_count(), 44);
    for (size_t i = 0; i < iso_live_keys_count(); i++) {
        const struct iso_config_key *key = iso_live_key_at(i);
        assert_int_not_equal(key->type, ISO_CONFIG_TEXT);
        assert_ptr_equal(iso_live_key_find(key->section, key->name), key);
    }
    assert_null(iso_live_key_at(iso_live_keys_count()));
    assert_true(iso_live_keys_count() <= ISO_LIVE_KEYS_MAX);
}

static void every_default_can_be_set(void **state)
{
    struct iso_config config = iso_config_default();
    char value[ISO_LIVE_VALUE_SIZE];
    (void)state;
    for (size_t i = 0; i < iso_live_keys_count(); i++) {
        const struct iso_config_key *key = iso_live_key_at(i);
        assert_int_equal(iso_live_key_set(&config, key, key->standard, NULL), 0);
        iso_live_key_print(&config, key, value);
        assert_string_equal(value, key->standard);
    }
}

static void a_bad_value_is_refused_as_in_the_file(void **state)
{
    struct iso_fault fault = {.text = ""};
    assert_int_equal(start(*state, "", &fault), 0);
    expect_refusal("lockout", "failures", "1001",
                   "bad value '1001' for 'failures' (a whole number, 0 to 1000)");
    expect_refusal("lockout", "failures", "two",
                   "bad value 'two' for 'failures' (a whole number, 0 to 1000)");
    expect_refusal("decision", "threshold", "nan",
                   "bad value 'nan' for 'threshold' (a number, -100 to 100)");
    expect_refusal("lockout", "first_ms", "900001", "[lockout] first_ms is above longest_ms");
    expect_refusal("lockout", "nothing", "1", "unknown key 'nothing' in [lockout]");
    expect_refusal("nothing", "failures", "1", "unknown key 'failures' in [nothing]");
    expect_refusal("sensor", "device", "/dev/video0",
                   "[sensor] device cannot be changed while the daemon runs: change it in the "
                   "configuration file and restart the daemon");
    assert_int_equal(world.config.lockout.failures, 5);
}

/* ---- the file ---- */

static void changes_hold_after_a_restart(void **state)
{
    struct iso_fault fault = {.text = ""};
    assert_int_equal(start(*state, "[lockout]\nattacks = 4\n", &fault), 0);
    assert_false(scratch_exists(world.path));
    change("lockout", "failures", "7");
    change("lockout", "attacks", "9");
    change("decision", "level", "strict");
    assert_int_equal(world.config.lockout.failures, 7);
    assert_int_equal(world.settings.configured.lockout.failures, 5);
    change("lockout", "attacks", NULL);
    assert_int_equal(world.config.lockout.attacks, 4);

    assert_int_equal(start(*state, "[lockout]\nattacks = 6\n", &fault), 0);
    assert_string_equal(world.warned, "");
    assert_int_equal(world.config.lockout.failures, 7);
    assert_int_equal(world.config.lockout.attacks, 6);
    assert_int_equal(world.config.decision.level, ISO_LEVEL_STRICT);
    assert_int_equal(world.settings.file.number, 4);
    assert_int_equal(world.settings.file.n, 2);
}

/* Two settings that fit to each other, but not one by one to the configuration file. */
static void changes_that_belong_together_hold_together(void **state)
{
    struct iso_fault fault = {.text = ""};
    assert_int_equal(start(*state, "", &fault), 0);
    change("decision", "max_frames", "12");
    change("decision", "agree", "9");
    change("decision", "max_frames", "10"); /* the later one of the file */
    assert_int_equal(start(*state, "", &fault), 0);
    assert_string_equal(world.warned, "");
    assert_int_equal(world.config.decision.agree, 9);
    assert_int_equal(world.config.decision.max_frames, 10);
}

static void a_stored_value_that_no_longer_fits_is_reported(void **state)
{
    struct iso_fault fault = {.text = ""};
    assert_int_equal(start(*state, "", &fault), 0);
    change("lockout", "first_ms", "800000");
    change("hint", "hold_frames", "5");
    world.settings.file.items[2] = (struct iso_stored_setting){"old", "name", "1"};
    world.settings.file.items[3] = (struct iso_stored_setting){"door", "fail", "safe"};
    world.settings.file.n = 4;
    assert_int_equal(iso_live_settings_renew(&world.settings, &fault), 0);
    assert_int_equal(start(*state, "[lockout]\nlongest_ms = 700000\n", &fault), 0);
    assert_string_equal(
        world.warned,
        "the stored setting [lockout] first_ms = 800000 is not used, the configuration file's "
        "value holds: [lockout] first_ms is above longest_ms\n"
        "the stored setting [old] name = 1 is not used, the configuration file's value holds: "
        "unknown key 'name' in [old]\n"
        "the stored setting [door] fail = safe is not used, the configuration file's value holds: "
        "[door] fail cannot be changed while the daemon runs: change it in the configuration file "
        "and restart the daemon\n");
    assert_int_equal(world.config.lockout.first_ms, 30000);
    assert_int_equal(world.config.hint.hold_frames, 5);
    assert_int_equal(world.config.door.fail, ISO_DOOR_FAIL_SECURE);
    assert_int_equal(world.settings.file.n, 1);
}

/* Every byte of the file is sealed. */
static void a_file_that_was_changed_is_refused(void **state)
{
    struct iso_fault fault = {.text = ""};
    assert_int_equal(start(*state, "", &fault), 0);
    change("decision", "threshold", "9");
    size_t size = 0;
    uint8_t *bytes = scratch_read(world.path, &size);
    for (size_t i = 0; i < size; i++) {
        bytes[i] ^= 0x10;
        scratch_write(world.path, bytes, size);
        bytes[i] ^= 0x10;
        assert_int_equal(start(*state, "", &fault), -EBADMSG);
        assert_true(world.config.decision.threshold < 1);
    }
    for (size_t n = 0; n < size; n++) {
        scratch_write(world.path, bytes, n);
        assert_int_equal(start(*state, "", &fault), -EBADMSG);
    }
    scratch_write(world.path, bytes, size);
    assert_int_equal(start(*state, "", &fault), 0);
    assert_true(world.config.decision.threshold > 8);
    free(bytes);
}

static void a_key_that_is_dropped_opens_it_no_more(void **state)
{
    struct iso_key_ring *ring = stores_ring(*state);
    struct iso_fault fault = {.text = ""};
    uint32_t number = 0;
    assert_int_equal(start(*state, "", &fault), 0);
    change("decision", "margin", "3");
    assert_int_equal(iso_key_ring_add(ring, ISO_KEY_ANCHOR, &number, &fault), 0);
    assert_int_equal(iso_live_settings_renew(&world.settings, &fault), 0);
    assert_int_equal(iso_key_ring_drop(ring, ISO_KEY_ANCHOR, number, &fault), 0);
    assert_int_equal(start(*state, "", &fault), 0);
    assert_true(world.config.decision.margin > 2);
    assert_int_equal(iso_key_ring_add(ring, ISO_KEY_ANCHOR, &number, &fault), 0);
    assert_int_equal(iso_key_ring_drop(ring, ISO_KEY_ANCHOR, number, &fault), 0);
    assert_int_equal(start(*state, "", &fault), -EBADMSG);
}

static void without_a_path_changes_end_with_the_daemon(void **state)
{
    struct iso_fault fault = {.text = ""};
    (void)state;
    world.config = iso_config_default();
    iso_live_settings_init(&world.settings, &world.config, "", NULL);
    assert_int_equal(iso_live_settings_load(&world.settings, warn, &world, &fault), 0);
    change("hint", "interval_ms", "2000");
    assert_int_equal(world.config.hint.interval_ms, 2000);
    assert_int_equal(iso_live_settings_renew(&world.settings, &fault), 0);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_that_need_a_restart_are_not_changed),
        cmocka_unit_test(every_default_can_be_set),
        TEST(a_bad_value_is_refused_as_in_the_file),
        TEST(changes_hold_after_a_restart),
        TEST(changes_that_belong_together_hold_together),
        TEST(a_stored_value_that_no_longer_fits_is_reported),
        TEST(a_file_that_was_changed_is_refused),
        TEST(a_key_that_is_dropped_opens_it_no_more),
        TEST(without_a_path_changes_end_with_the_daemon),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
