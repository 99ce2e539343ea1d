/* The signals about the sensor's frames: hints, reasons, and the view for a client that aims the
 * sensor. */
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/contract.h"
#include "tests/firmware/rigs/bus_rig.h"

/* The signal for each outcome of isotherm/capture.h has the word of that outcome. */
static void sends_every_hint_to_all_clients(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    int n = 0;
    for (int i = 0; i < ISO_CAPTURES; i++) {
        const enum iso_capture capture = (enum iso_capture)i;
        if (capture == ISO_CAPTURE_OK || capture == ISO_CAPTURE_NO_FACE ||
            capture == ISO_CAPTURE_NOBODY || capture == ISO_CAPTURE_NOT_A_FACE ||
            iso_capture_is_attack(capture)) {
            continue; /* NOT_A_FACE: only if it moves, see test_still_scene.c */
        }
        char wanted[64];
        rig_show_unusable(f->rig, capture, 3);
        bus_rig_run(f, 3000); /* and earlier frames do not count any more */
        (void)snprintf(wanted, sizeof wanted, "Hint %s", iso_capture_name(capture));
        assert_string_equal(bus_rig_news(f, 0), wanted);
        assert_string_equal(bus_rig_news(f, 1), wanted);
        n++;
    }
    assert_int_equal(n, 20);
    for (int i = ISO_CAPTURE_FLAT; i < ISO_CAPTURES; i++) {
        char wanted[64];
        rig_show_unusable(f->rig, (enum iso_capture)i, 2);
        bus_rig_run(f, 12000);
        assert_string_equal(bus_rig_news(f, 0), "Visit deny");
        (void)snprintf(wanted, sizeof wanted, "\"reason\":\"%s\",\"attack_frames\":2",
                       iso_capture_name((enum iso_capture)i));
        assert_non_null(strstr(rig_record(f->rig, "attack"), wanted));
    }
}

/* Reads only the first seven arguments of the signal, as an older client does. */
static int read_reason(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    const char *verdict, *person, *reason;
    double score, threshold;
    uint32_t frames;
    int64_t latency_us;
    (void)error;
    assert_true(sd_bus_message_read(signal, "ssdduxs", &verdict, &person, &score, &threshold,
                                    &frames, &latency_us, &reason) > 0);
    (void)snprintf(context, 64, "%s %s %s %u", verdict, person, reason, frames);
    return 0;
}

static int read_door(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    const char *door, *door_fault;
    (void)error;
    assert_true(sd_bus_message_has_signature(signal, "ssdduxsss"));
    assert_true(sd_bus_message_skip(signal, "ssdduxs") > 0);
    assert_true(sd_bus_message_read(signal, "ss", &door, &door_fault) > 0);
    (void)snprintf(context, 64, "'%s' '%s'", door, door_fault);
    return 0;
}

static void sends_the_result_of_the_door(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    char door[64] = "";
    assert_true(sd_bus_match_signal(f->client[1], NULL, ISO_CONTRACT_NAME, ISO_CONTRACT_PATH,
                                    ISO_CONTRACT_INTERFACE, ISO_CONTRACT_VISIT, read_door,
                                    door) >= 0);
    rig_enrol(f->rig, "anna", 50);
    rig_show(f->rig, 90, 6);
    bus_rig_run(f, 300);
    assert_string_equal(door, "'' ''");
    bus_rig_run(f, 5000);
    rig_show(f->rig, 50, 2);
    bus_rig_run(f, 100);
    assert_string_equal(door, "'unlocked' ''");
}

static void sends_the_reason_of_a_visit(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    char reason[64] = "";
    assert_true(sd_bus_match_signal(f->client[1], NULL, ISO_CONTRACT_NAME, ISO_CONTRACT_PATH,
                                    ISO_CONTRACT_INTERFACE, ISO_CONTRACT_VISIT, read_reason,
                                    reason) >= 0);
    rig_enrol(f->rig, "anna", 50);
    rig_show_unusable(f->rig, ISO_CAPTURE_WRONG_SIZE, 2);
    bus_rig_run(f, 10000);
    assert_string_equal(reason, "deny  attack 0");
    rig_show(f->rig, 50, 2);
    bus_rig_run(f, 100);
    assert_string_equal(reason, "allow anna match 2");
}

/* ---- aiming ---- */

static void sends_the_view_while_a_client_aims(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    rig_show_at(f->rig, 50, 30, 10);
    bus_rig_run(f, 200);
    assert_string_equal(bus_rig_news(f, 0), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_AIM_STOP, NULL), "NoActionInProgress");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_AIM_START, NULL), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_AIM_START, NULL),
                        ""); /* a second call does no harm */
    rig_show_at(f->rig, 50, 30, 10);
    bus_rig_run(f, 200);
    assert_string_equal(bus_rig_news(f, 0), "View ");
    assert_string_equal(bus_rig_news(f, 1), ""); /* no other client gets it */
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_AIM_START, NULL), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_AIM_STOP, NULL), "");
    rig_show_at(f->rig, 50, 30, 10);
    bus_rig_run(f, 200);
    assert_null(strstr(bus_rig_news(f, 0), "View"));
    assert_non_null(strstr(bus_rig_news(f, 1), "View"));
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_AIM_STOP, NULL), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_AIM_START, NULL), ""); /* it starts again */
    rig_show_at(f->rig, 50, 30, 10);
    bus_rig_run(f, 200);
    assert_non_null(strstr(bus_rig_news(f, 0), "View"));
}

static void a_client_that_leaves_the_bus_stops_aiming(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_AIM_START, NULL), "");
    assert_true(iso_appliance_is_aimed(f->rig->appliance));
    sd_bus_flush_close_unref(f->client[0]);
    f->client[0] = NULL;
    for (int i = 0; i < BUS_RIG_ROUNDS && iso_appliance_is_aimed(f->rig->appliance); i++) {
        bus_rig_go_round(f);
    }
    assert_false(iso_appliance_is_aimed(f->rig->appliance));
    f->client[0] = bus_rig_connect(f->told[0]);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, bus_rig_setup, bus_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(sends_every_hint_to_all_clients),
        TEST(sends_the_reason_of_a_visit),
        TEST(sends_the_result_of_the_door),
        TEST(sends_the_view_while_a_client_aims),
        TEST(a_client_that_leaves_the_bus_stops_aiming),
    };
    return cmocka_run_group_tests(tests, bus_rig_group_setup, bus_rig_group_teardown);
}
