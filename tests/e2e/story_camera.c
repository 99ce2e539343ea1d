#include "tests/e2e/story.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/e2e/answers.h"
#include "tests/e2e/appliance.h"

void a_person_who_stands_badly_gets_a_hint(void **state)
{
    json_t *document = appliance_run_json(*state, "identify --timeout 4", "none-cut4", 5);

    assert_string_equal(answer_text(document, "result"), "identify-timed-out");
    assert_string_equal(json_string_value(json_array_get(json_object_get(document, "hints"), 0)),
                        "move-right");
    json_decref(document);
    document = appliance_run_json(*state, "status", NULL, 0);
    assert_string_equal(answer_text(document, "capture"), "move-right");
    json_decref(document);
}

/* The room has a wall, but no person. The appliance gives no hint. */
void an_empty_room_gets_no_hint(void **state)
{
    const struct appliance *appliance = *state;
    const char *const argv[] = {appliance_isotherm, "--bus", appliance->bus.address, "aim", NULL};
    struct run aim;
    json_t *document = appliance_run_json(*state, "status", NULL, 0);
    const json_int_t denied = answer_number(document, "visits-denied");

    json_decref(document);
    document = appliance_run_json(*state, "identify --timeout 3", "none-nobody1", 5);
    assert_string_equal(answer_text(document, "result"), "identify-timed-out");
    assert_int_equal(json_array_size(json_object_get(document, "hints")), 0);
    json_decref(document);
    document = appliance_run_json(*state, "status", NULL, 0);
    assert_string_equal(answer_text(document, "capture"), "nobody");
    assert_int_equal(answer_number(document, "visits-denied"), denied);
    json_decref(document);
    run_start(&aim, argv);
    run_until(&aim, "capture ");
    appliance_show(appliance, "none-nobody1");
    run_until(&aim, "nobody is there");
    kill(aim.pid, SIGINT);
    run_finish(&aim);
    appliance_show(appliance, NULL);
    assert_null(strstr(aim.out, "look straight"));
    run_free(&aim);
}

/* In a single frame a chair within reach looks like a visitor without a face, but a chair does not
 * move. The recording is short. It is repeated until the appliance has forgotten the previous
 * visitor. */
void a_room_with_a_chair_gets_no_hint(void **state)
{
    static const struct timespec half_a_second = {0, 500000000};
    bool empty = false;

    for (int i = 0; i < 60 && !empty; i++) {
        appliance_show(*state, "none-nobody2");
        nanosleep(&half_a_second, NULL);
        json_t *status = appliance_run_json(*state, "status", NULL, 0);
        empty = strcmp(answer_text(status, "capture"), "nobody") == 0;
        json_decref(status);
    }
    assert_true(empty);
    json_t *document = appliance_run_json(*state, "identify --timeout 3", "none-nobody2", 5);
    assert_string_equal(answer_text(document, "result"), "identify-timed-out");
    assert_int_equal(json_array_size(json_object_get(document, "hints")), 0);
    json_decref(document);
    document = appliance_run_json(*state, "status", NULL, 0);
    assert_string_equal(answer_text(document, "capture"), "nobody");
    json_decref(document);
}

/* `isotherm aim` shows what the camera sees while the door stays in service. */
void the_camera_can_be_aimed(void **state)
{
    const struct appliance *appliance = *state;
    const char *const argv[] = {appliance_isotherm, "--bus", appliance->bus.address, "aim", NULL};
    struct run aim;

    run_start(&aim, argv);
    run_until(&aim, "capture ");
    appliance_show(appliance, "p01-v1");
    run_until(&aim, "good, hold still");
    kill(aim.pid, SIGINT);
    run_finish(&aim);
    appliance_show(appliance, NULL);
    run_expect(&aim, 0);
    run_free(&aim);

    json_t *status = appliance_run_json(appliance, "status", NULL, 0);
    const double distance_mm = json_real_value(json_object_get(status, "distance-mm"));
    const double coverage = json_real_value(json_object_get(status, "fit-coverage"));
    assert_string_equal(answer_text(status, "mode"), "watch");
    assert_true(distance_mm > 400 && distance_mm < 1200);
    assert_true(coverage > 0.8 && coverage <= 1);
    json_decref(status);
}

void a_camera_in_use_is_refused_and_freed_by_an_interrupt(void **state)
{
    const struct appliance *appliance = *state;
    const char *const argv[] = {appliance_isotherm, "--bus", appliance->bus.address, "identify",
                                NULL};
    struct run first;

    run_start(&first, argv);
    run_until(&first, "Look straight at the camera.");
    answer_expect_error(appliance, "identify", 4, "already-in-use");
    kill(first.pid, SIGINT);
    run_finish(&first);
    run_expect(&first, 130);
    run_free(&first);
    json_t *status = appliance_run_json(appliance, "status", NULL, 0);
    assert_string_equal(answer_text(status, "mode"), "watch");
    json_decref(status);
}

void a_client_that_dies_frees_the_camera(void **state)
{
    const struct appliance *appliance = *state;
    const char *const argv[] = {appliance_isotherm, "--bus", appliance->bus.address,
                                "enroll",           "zoe",   NULL};
    struct run first;

    run_start(&first, argv);
    run_until(&first, "look straight at the camera.");
    kill(first.pid, SIGKILL);
    run_finish(&first);
    run_free(&first);
    appliance_expect(appliance_run(appliance, "verify p01", "p01-v1"), 0);
    assert_int_equal(answer_people(appliance), 3);
}
