/* What the pages see of updates: RAUC, for which a stand-in is on a private bus, and the result of
 * the last update; and the restart into one. */
#include <stdio.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/enroll/rigs/fake_rauc.h"
#include "tests/enroll/web/update/update_rig.h"
#include "tests/support/scratch.h"

static const struct fake_rauc_script idle;

static void version_and_slots_are_seen(void **state)
{
    struct fake_rauc rauc;
    (void)state;

    fake_rauc_start(&rauc, update_rig.bus.address, &idle);
    json_t *seen = update_rig_look(), *slots = json_object_get(seen, "slots");
    assert_true(json_is_null(json_object_get(seen, "hindrance")));
    assert_string_equal(update_rig_word(seen, "version"), "1.0.0");
    assert_string_equal(update_rig_word(seen, "image"), "isotherm-test");
    assert_string_equal(update_rig_word(seen, "operation"), "idle");
    assert_int_equal(json_array_size(slots), 2);
    assert_string_equal(update_rig_word(json_array_get(slots, 1), "slot"), "a");
    assert_true(json_is_true(json_object_get(json_array_get(slots, 1), "running")));
    assert_true(json_is_true(json_object_get(json_array_get(slots, 1), "next")));
    assert_false(json_is_true(json_object_get(seen, "handed_over")));
    assert_true(json_is_null(json_object_get(seen, "last")));
    json_decref(seen);
    assert_string_equal(fake_rauc_stop(&rauc), ""); /* it was asked to install nothing */
}

static void an_installation_is_seen(void **state)
{
    const struct fake_rauc_script busy = {.busy = true};
    struct fake_rauc rauc;
    (void)state;

    fake_rauc_start(&rauc, update_rig.bus.address, &busy);
    json_t *seen = update_rig_look();
    assert_string_equal(update_rig_word(seen, "operation"), "installing");
    assert_int_equal(json_integer_value(json_object_get(seen, "percent")), 40);
    assert_int_equal(json_array_size(json_object_get(seen, "slots")), 0);
    json_decref(seen);
    (void)fake_rauc_stop(&rauc);
}

static void a_machine_without_image_is_told(void **state)
{
    struct https client;
    (void)state;

    json_t *seen = update_rig_look(); /* the update_rig.folder is there, and RAUC is not */
    assert_string_equal(update_rig_word(seen, "hindrance"), "no-image");
    json_decref(seen);
    assert_int_equal(rmdir(update_rig_page("")), 0);
    seen = update_rig_look();
    assert_string_equal(update_rig_word(seen, "hindrance"), "no-image");
    json_decref(seen);
    update_rig_announce(&client, 6);
    update_rig_expect_answer(&client, 409, "no-image");
}

static void expect_last(const char *result, const char *from, const char *version, const char *code)
{
    scratch_write_text(scratch_path(update_rig.folder, "result.json"), result);
    json_t *seen = update_rig_look();
    const json_t *last = json_object_get(seen, "last");
    assert_string_equal(update_rig_word(last, "from"), from);
    assert_string_equal(update_rig_word(last, "version"), version);
    assert_string_equal(update_rig_word(last, "code"), code);
    json_decref(seen);
}

static void what_became_of_the_last_update_is_seen(void **state)
{
    (void)state;
    expect_last("{\"from\":\"page\",\"at_s\":1764170000,\"result\":{\"installed\":true,"
                "\"slot\":\"b\",\"version\":\"2.0.0\"}}",
                "page", "2.0.0", "");
    expect_last("{\"from\":\"stick\",\"at_s\":1764170000,\"result\":{\"error\":{\"code\":"
                "\"not-newer\",\"message\":\"it is not newer\",\"exit_code\":1}}}",
                "stick", "", "not-newer");
    expect_last("{\"from\":\"page\",\"at_s\":1764170000,\"result\":{}}", "", "", "");
    expect_last("{\"from\":\"page\",", "", "", "");
}

/* ---- the restart ---- */

static void the_machine_restarts_only_into_an_update(void **state)
{
    const struct fake_rauc_script installed = {.installed = true};
    struct fake_rauc rauc;
    (void)state;

    fake_rauc_start(&rauc, update_rig.bus.address, &idle);
    api_rig_expect("POST", UPDATE_RIG_PATH "/restart", update_rig.json_head, "{}", 409,
                   "no-update");
    (void)fake_rauc_stop(&rauc);
    assert_false(scratch_exists(update_rig_page("restart")));
    assert_string_equal(api_rig.said, "");
    fake_rauc_start(&rauc, update_rig.bus.address, &installed);
    api_rig_expect("POST", UPDATE_RIG_PATH "/restart", update_rig.json_head, "{}", 202, NULL);
    (void)fake_rauc_stop(&rauc);
    assert_string_equal(api_rig.said, "ada restart \n");
    assert_true(scratch_exists(update_rig_page("restart")));
}

/* The policy of the bus refuses this client: the last test, because it changes the bus. */
static void a_web_server_without_the_right_says_so(void **state)
{
    const char *path = scratch_path(*state, "policy.conf");
    struct fake_rauc rauc;

    scratch_write_text(path, "<busconfig><policy context=\"mandatory\">"
                             "<deny send_destination=\"de.pengutronix.rauc\"/></policy>"
                             "</busconfig>");
    private_bus_kill(&update_rig.bus);
    private_bus_include(&update_rig.bus, path);
    assert_true(private_bus_revive(&update_rig.bus));
    fake_rauc_start(&rauc, update_rig.bus.address, &idle);
    json_t *seen = update_rig_look();
    assert_string_equal(update_rig_word(seen, "hindrance"), "denied");
    json_decref(seen);
    (void)fake_rauc_stop(&rauc);
}

int main(void)
{
#define ON_RIG(test) cmocka_unit_test_setup_teardown(test, update_rig_setup, update_rig_teardown)
    const struct CMUnitTest tests[] = {
        ON_RIG(version_and_slots_are_seen),
        ON_RIG(an_installation_is_seen),
        ON_RIG(a_machine_without_image_is_told),
        ON_RIG(what_became_of_the_last_update_is_seen),
        ON_RIG(the_machine_restarts_only_into_an_update),
        ON_RIG(a_web_server_without_the_right_says_so),
    };

    if (!private_bus_start(&update_rig.bus)) {
        return TEST_SKIPPED;
    }
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    private_bus_stop(&update_rig.bus);
    return failed;
}
