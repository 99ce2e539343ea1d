/* The configuration: its defaults, every refusal with its line, and the options of the back ends.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "core/match/distance.h"
#include "drivers/base/times.h"
#include "drivers/door/door_io.h"
#include "drivers/sensor/contract/sensor.h"
#include "firmware/config/config.h"
#include "isotherm/extract.h"
#include "tests/support/scratch.h"

static void holds_defaults_without_a_file(void **state)
{
    const struct iso_config config = iso_config_default();
    const struct iso_extract_options extract = iso_extract_options_default();
    const struct iso_match_options match = iso_match_options_default();
    (void)state;
    assert_string_equal(config.sensor.backend, "replay");
    assert_string_equal(config.door.backend, "null");
    assert_int_equal(config.door.fail, ISO_DOOR_FAIL_SECURE);
    assert_int_equal(config.decision.agree, 2);
    assert_true(config.log.sync);
    assert_string_equal(config.bus.address, "system");
    /* Core and configuration both define them, so they have to agree. */
    assert_true(config.sensor.distance_min_mm == extract.distance_min_mm);
    assert_true(config.sensor.distance_max_mm == extract.distance_max_mm);
    assert_true(config.match.trim == match.trim);
    assert_int_equal(config.match.icp_iterations, match.icp_iterations);
    assert_int_equal(config.match.transform, match.transform);
}

static void a_level_stands_for_a_threshold(void **state)
{
    static const struct {
        const char *text;
        double threshold;
    } cases[] = {{"", 3},
                 {"[decision]\nlevel = convenient\n", 2},
                 {"[decision]\nlevel = strict\n", 4},
                 {"[decision]\nlevel = strict\nthreshold = 2.5\n", 2.5},
                 {"[decision]\nthreshold = -7\n", -7}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct iso_config config;
        struct iso_fault fault = {.text = ""};
        assert_int_equal(iso_config_parse("level", cases[i].text, &config, &fault), 0);
        assert_true(iso_config_threshold(&config) == cases[i].threshold);
    }
}

static double threshold_among(const char *text, size_t n_people)
{
    struct iso_config config;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_config_parse("level", text, &config, &fault), 0);
    return iso_config_threshold_among(&config, n_people, false);
}

/* The rate of a level holds for a whole visit. With ten times the people, the probability that one
 * comparison is wrong may be only a tenth. */
static void the_threshold_grows_with_the_people(void **state)
{
    (void)state;
    assert_true(threshold_among("", 0) == 3);
    assert_true(threshold_among("", 1) == 3);
    assert_true(threshold_among("", 10) == 3);
    assert_float_equal(threshold_among("", 20), 3.30103, 1e-5);
    assert_float_equal(threshold_among("", 100), 4, 1e-12);
    assert_float_equal(threshold_among("[decision]\nlevel = strict\n", 10000), 7, 1e-12);
    assert_true(threshold_among("[decision]\nthreshold = 2.5\n", 10000) == 2.5);
    assert_true(threshold_among("[match]\nmethod = distance\n", 10000) == 3);
}

static void every_default_is_sound(void **state)
{
    (void)state;
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        const struct iso_config_key *key = &iso_config_keys[i];
        struct iso_config config;
        struct iso_fault fault = {.text = ""};
        char text[256];
        (void)snprintf(text, sizeof text, "[%s]\n%s = %s\n", key->section, key->name,
                       key->standard);
        if (iso_config_parse("default", text, &config, &fault)) {
            fail_msg("%s", fault.text);
        }
        assert_non_null(key->help);
        assert_null(strchr(key->help, '\n'));
    }
}

static void reads_every_type(void **state)
{
    struct iso_config config;
    (void)state;
    assert_int_equal(iso_config_parse("c",
                                      "; a comment\n"
                                      "[sensor]\n"
                                      "path = /srv/slot ; where visitors stand\n"
                                      "distance_min_mm = 412.5\n"
                                      "[door]\n"
                                      "fail=safe\n"
                                      "unlock_ms = 700\n"
                                      "[log]\n"
                                      "sync = no\n"
                                      "[match]\n"
                                      "transform = affine",
                                      &config, NULL),
                     0);
    assert_string_equal(iso_config_option(&config.sensor.options, "path"), "/srv/slot");
    assert_string_equal(iso_config_option(&config.sensor.options, "pace"), "");
    assert_true(config.sensor.distance_min_mm == 412.5);
    assert_int_equal(config.door.fail, ISO_DOOR_FAIL_SAFE);
    assert_int_equal(config.door.unlock_ms, 700);
    assert_false(config.log.sync);
    assert_int_equal(config.match.transform, ISO_ICP_AFFINE);
    assert_int_equal(config.door.held_ms, 30000);
}

/* A file for an earlier version. */
static void accepts_and_names_an_obsolete_key(void **state)
{
    (void)state;
    struct iso_config config = {.obsolete = NULL};
    assert_int_equal(iso_config_parse("c", "[process]\nthreads = 2\nconfine = no", &config, NULL),
                     0);
    assert_string_equal(config.obsolete, "[process] threads");
    assert_false(config.process.confine);
    assert_int_equal(iso_config_parse("c", "[process]\nconfine = yes", &config, NULL), 0);
    assert_null(config.obsolete);
}

static void refuses(const char *text, const char *message)
{
    struct iso_config config = {.door.unlock_ms = 4711};
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_config_parse("door.conf", text, &config, &fault), -EINVAL);
    assert_string_equal(fault.text, message);
    assert_int_equal(config.door.unlock_ms, 4711); /* unchanged */
}

static void refuses_unknown_sections_and_keys(void **state)
{
    (void)state;
    refuses("[door]\nunlock_ms = 700\n[wall]\nheight = 3\n", "door.conf:3: unknown section [wall]");
    refuses("\n\n[wall]\n", "door.conf:3: unknown section [wall]");
    refuses("[door]\n# color\ncolour = red\n", "door.conf:3: unknown key 'colour' in [door]");
    refuses("unlock_ms = 700\n", "door.conf:1: key 'unlock_ms' is in no known section");
    refuses("[gallery]\nunlock_ms = 700\n", "door.conf:2: unknown key 'unlock_ms' in [gallery]");
}

/* `backend` and the option may be in either order. */
static void hands_options_to_the_back_end_that_is_named(void **state)
{
    struct iso_config config;
    struct iso_option options[ISO_CONFIG_OPTIONS_MAX];
    struct iso_fault fault = {.text = ""};
    (void)state;
    assert_int_equal(
        iso_config_parse("c", "[door]\ninputs = /i\nbackend = null\n", &config, &fault), 0);
    assert_int_equal(iso_config_door_options(&config, options), 1);
    assert_string_equal(options[0].key, "inputs");
    assert_string_equal(options[0].value, "/i");
    assert_int_equal(config.door.options.list[0].line, 2);
#ifdef ISOTHERM_WITH_GPIOD
    refuses("[door]\ninputs = /i\nbackend = gpiod\n",
            "door.conf:2: the door gpiod has no option 'inputs'; back ends that have it: null");
    refuses("[door]\nbackend = null\nrelay = GPIO17\n",
            "door.conf:3: the door null has no option 'relay'; back ends that have it: gpiod");
    refuses("[door]\nrelay = foo:70000\nbackend = gpiod\n",
            "door.conf:2: relay: 'foo:70000' is not a line (CHIP:OFFSET or NAME)");
#endif
    refuses("[sensor]\n\nloop = maybe\npath = /p\n",
            "door.conf:3: bad value 'maybe' for 'loop' (no|yes)");
    refuses("[sensor]\npath = /p\nloop = no\npath = /q\n", "door.conf:4: 'path' is given twice");
    refuses("[sensor]\nrecord = /r.oni\nbackend = openni2\n[door]\ncolour = 3\n",
            iso_sensor_options("openni2") ? "door.conf:2: unknown key 'record' in [sensor]"
                                          : "door.conf:5: unknown key 'colour' in [door]");
    refuses("[door]\ncolour = 3\n[sensor]\ncolour = 3\n",
            "door.conf:2: unknown key 'colour' in [door]");
}

/* An empty value counts as not set, also that of an option of another back end. */
static void accepts_empty_options(void **state)
{
    struct iso_config config;
    struct iso_option options[ISO_CONFIG_OPTIONS_MAX];
    struct iso_fault fault = {.text = ""};
    const char *name;
    (void)state;
    for (size_t b = 0; (name = iso_sensor_registered(b)); b++) {
        for (const struct iso_option_spec *spec = iso_sensor_options(name); spec->name; spec++) {
            char text[128];
            (void)snprintf(text, sizeof text, "[sensor]\nbackend = replay\n%s =\n", spec->name);
            if (iso_config_parse("c", text, &config, &fault) && !spec->tools_only) {
                fail_msg("%s", fault.text);
            }
            assert_int_equal(iso_config_sensor_options(&config, options), 0);
        }
    }
    refuses("[sensor]\ncolour =\n", "door.conf:2: unknown key 'colour' in [sensor]");
}

/* The function that opens the back end reports that it does not exist, and lists those that do. */
static void leaves_unknown_back_ends_to_their_registry(void **state)
{
    struct iso_config config;
    struct iso_option options[ISO_CONFIG_OPTIONS_MAX];
    (void)state;
    assert_int_equal(
        iso_config_parse("c", "[sensor]\nbackend = kinect9\ngain = 3\n", &config, NULL), 0);
    assert_string_equal(config.sensor.backend, "kinect9");
    assert_int_equal(iso_config_sensor_options(&config, options), 0);
}

static void sets_an_option_as_a_line_does(void **state)
{
    struct iso_config config = iso_config_default();
    struct iso_option options[ISO_CONFIG_OPTIONS_MAX];
    struct iso_fault fault = {.text = ""};
    (void)state;
    assert_int_equal(iso_config_set_sensor_option(&config, "path", "/p", &fault), 0);
    assert_int_equal(iso_config_sensor_options(&config, options), 1);
    assert_string_equal(options[0].value, "/p");
    assert_int_equal(iso_config_set_sensor_option(&config, "path", "/q", &fault), 0);
    assert_int_equal(iso_config_sensor_options(&config, options), 1);
    assert_string_equal(options[0].value, "/q");
    assert_int_equal(iso_config_set_sensor_option(&config, "pace", "slow", &fault), -EINVAL);
    assert_string_equal(fault.text, "bad value 'slow' for 'pace' (realtime|asap)");
    assert_int_equal(iso_config_set_sensor_option(&config, "colour", "1", &fault), -EINVAL);
    assert_int_equal(iso_config_sensor_options(&config, options), 1);
    (void)strcpy(config.sensor.backend, "kinect9");
    assert_int_equal(iso_config_set_sensor_option(&config, "repeats", "yes", &fault), -EINVAL);
    assert_string_equal(fault.text, "the sensor kinect9 has no option 'repeats'; back ends that "
                                    "have it: replay");
}

static void refuses_bad_lines(void **state)
{
    char text[400] = "[door]\n";
    (void)state;
    refuses("[door]\nunlock_ms 700\n", "door.conf:2: not `key = value`");
    refuses("[door]\nunlock_ms 700\ncolour = red\n", "door.conf:2: not `key = value`");
    refuses("[door\nunlock_ms = 700\n", "door.conf:1: not `key = value`");
    refuses("[door]\nunlock_ms = 700\nheld_ms = 2000\nunlock_ms = 700\n",
            "door.conf:4: 'unlock_ms' is given twice");
    memset(text + 7, 'x', 191);
    refuses(text, "door.conf:2: line is longer than 190 bytes");
}

static void refuses_bad_values(void **state)
{
    (void)state;
    refuses("[door]\nunlock_ms = soon\n",
            "door.conf:2: bad value 'soon' for 'unlock_ms' (a whole number, 100 to 600000)");
    refuses("[door]\nunlock_ms = 99\n",
            "door.conf:2: bad value '99' for 'unlock_ms' (a whole number, 100 to 600000)");
    refuses("[door]\nunlock_ms = 700.5\n",
            "door.conf:2: bad value '700.5' for 'unlock_ms' (a whole number, 100 to 600000)");
    refuses("[door]\nfail = open\n", "door.conf:2: bad value 'open' for 'fail' (secure|safe)");
    refuses("[door]\nfail = sec\n", "door.conf:2: bad value 'sec' for 'fail' (secure|safe)");
    refuses("[log]\nsync = true\n", "door.conf:2: bad value 'true' for 'sync' (no|yes)");
    refuses("[decision]\nthreshold = nan\n",
            "door.conf:2: bad value 'nan' for 'threshold' (a number, -100 to 100)");
    refuses("[match]\ntrim = 1.01\n",
            "door.conf:2: bad value '1.01' for 'trim' (a number, 0.5 to 1)");
}

static void refuses_values_that_contradict_each_other(void **state)
{
    (void)state;
    refuses("[decision]\nagree = 7\nmax_frames = 6\n",
            "door.conf: [decision] agree is above max_frames");
    refuses("[sensor]\ndistance_min_mm = 900\ndistance_max_mm = 800\n",
            "door.conf: [sensor] distance_min_mm is not below distance_max_mm");
    refuses("[sensor]\nretry_ms = 500\nretry_max_ms = 400\n",
            "door.conf: [sensor] retry_ms is above retry_max_ms");
    refuses("[reader]\nd0 = gpiochip0:5\nd1 = gpiochip0:6\nosdp_port = /dev/ttyS1\n",
            "door.conf: [reader] osdp_port and the lines d0 and d1 exclude each other");
    refuses("[reader]\nosdp_key = /etc/isotherm/reader.key\n",
            "door.conf: [reader] osdp_key needs osdp_port");
    refuses("[reader]\nosdp_port = /dev/ttyS1\n[panel]\nport = /dev/ttyS1\n",
            "door.conf: [reader] osdp_port is the line of [panel] port");
    refuses("[door]\nbackend = gpio\n[login]\ndesk = yes\n",
            "door.conf: [login] desk needs [door] backend = null: a login would leave the door "
            "unwatched");
}

/* The angles of the poses exclude the frontal attitude, and the extractor accepts all of them. */
static void refuses_what_are_no_hours(void **state)
{
    static const char *const bad[] = {"5", "1-24", "-1-5", "3-3", "1-5h", "one-five"};
    struct iso_config config;
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[80];
        (void)snprintf(text, sizeof text, "[fleet]\nrestart_hours = %s\n", bad[i]);
        refuses(text, "door.conf: [fleet] restart_hours is not two hours of the day, such as 1-5");
    }
    assert_int_equal(iso_config_parse("c", "[fleet]\nrestart_hours = 22-5\n", &config, NULL), 0);
    assert_string_equal(config.fleet.restart_hours, "22-5");
}

static void refuses_poses_that_no_frame_can_show(void **state)
{
    const struct iso_extract_options extract = iso_extract_options_default();
    const double limit_rad = 40.0 * ISO_RAD_PER_DEG;
    struct iso_config config;
    (void)state;
    assert_float_equal(extract.yaw_max_rad, limit_rad, 1e-12);
    assert_float_equal(extract.pitch_max_rad, limit_rad, 1e-12);
    refuses("[enroll]\npose_yaw_deg = 6\n",
            "door.conf: [enroll] pose_within_deg is not below pose_yaw_deg");
    refuses("[enroll]\npose_pitch_deg = 5\n",
            "door.conf: [enroll] pose_within_deg is not below pose_pitch_deg");
    refuses("[enroll]\npose_yaw_deg = 34.5\n",
            "door.conf: [enroll] pose_yaw_deg and pose_within_deg together are above 40 degrees");
    refuses("[enroll]\npose_pitch_deg = 35\n",
            "door.conf: [enroll] pose_pitch_deg and pose_within_deg together are above 40 degrees");
    assert_int_equal(
        iso_config_parse("c", "[enroll]\npose_yaw_deg = 34\npose_pitch_deg = 7\n", &config, NULL),
        0);
}

static void names_a_file_that_does_not_exist(void **state)
{
    struct iso_config config;
    struct iso_fault fault = {.text = ""};
    (void)state;
    assert_int_equal(iso_config_load("/nonexistent/isotherm.conf", &config, &fault), -ENOENT);
    assert_string_equal(fault.text, "/nonexistent/isotherm.conf: No such file or directory");
}

static void hands_on_the_options_that_are_given(void **state)
{
    struct iso_config config;
    struct iso_option options[ISO_CONFIG_OPTIONS_MAX];
    (void)state;
    assert_int_equal(
        iso_config_parse("c", "[sensor]\npath = /srv/slot\nloop = yes\n", &config, NULL), 0);
    assert_int_equal(iso_config_sensor_options(&config, options), 2);
    assert_string_equal(options[0].key, "path");
    assert_string_equal(options[0].value, "/srv/slot");
    assert_string_equal(options[1].key, "loop");
    assert_int_equal(iso_config_door_options(&config, options), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(holds_defaults_without_a_file),
        cmocka_unit_test(a_level_stands_for_a_threshold),
        cmocka_unit_test(the_threshold_grows_with_the_people),
        cmocka_unit_test(every_default_is_sound),
        cmocka_unit_test(reads_every_type),
        cmocka_unit_test(accepts_and_names_an_obsolete_key),
        cmocka_unit_test(refuses_unknown_sections_and_keys),
        cmocka_unit_test(hands_options_to_the_back_end_that_is_named),
        cmocka_unit_test(accepts_empty_options),
        cmocka_unit_test(leaves_unknown_back_ends_to_their_registry),
        cmocka_unit_test(sets_an_option_as_a_line_does),
        cmocka_unit_test(refuses_bad_lines),
        cmocka_unit_test(refuses_bad_values),
        cmocka_unit_test(refuses_values_that_contradict_each_other),
        cmocka_unit_test(refuses_what_are_no_hours),
        cmocka_unit_test(refuses_poses_that_no_frame_can_show),
        cmocka_unit_test(names_a_file_that_does_not_exist),
        cmocka_unit_test(hands_on_the_options_that_are_given),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
