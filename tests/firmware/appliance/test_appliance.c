/* The appliance at the door: visits, sensor, lines, log. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_null.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/support/scratch.h"

/* ---- visits ---- */

static void admits_a_known_person(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 52, 3);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
    assert_true(rig_relay(rig));
    assert_string_equal(rig->puppet.sensor, "puppet9");
    assert_string_equal(iso_appliance_status(rig->appliance).last_outcome, "allow anna");
    const char *record = rig_record(rig, "visit");
    assert_non_null(strstr(record, "\"person\":\"anna\",\"verdict\":\"allow\","
                                   "\"door\":\"unlocked\",\"grant\":"));
    assert_non_null(strstr(record, ",\"reason\":\"match\",\"score\":8,\"threshold\":6,"
                                   "\"frames\":2,\"sensor\":\"started\"}"));
    rig_run(rig, 5000);
    assert_string_equal(rig_news(rig), "door locked time");
    assert_false(rig_relay(rig));
}

static void refuses_a_stranger(void **state)
{
    struct rig *rig = *state;
    bool lit = false;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 55, 6);
    rig_run(rig, 300);
    assert_string_equal(rig_news(rig), "visit deny unknown 6");
    assert_false(rig_relay(rig));
    assert_int_equal(iso_door_null_get_output(rig->door_io, ISO_DOOR_LED_REFUSED, &lit), 0);
    assert_true(lit);
    assert_non_null(strstr(rig_record(rig, "visit"),
                           "\"verdict\":\"deny\",\"reason\":\"unknown\","
                           "\"score\":5,\"threshold\":6,\"frames\":6,\"sensor\":\"started\"}"));
    assert_null(strstr(rig_record(rig, "visit"), "anna"));
    assert_string_equal(iso_appliance_status(rig->appliance).last_outcome, "deny");
}

static void refuses_a_person_who_leaves(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 50, 1);
    rig_run(rig, 1500);
    assert_string_equal(rig_news(rig), "");
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "visit deny left 1");
}

static void refuses_everybody_with_an_empty_gallery(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    rig_show(rig, 50, 6);
    rig_run(rig, 300);
    assert_string_equal(rig_news(rig), "visit deny unknown 6");
    assert_null(strstr(rig_record(rig, "visit"), "score"));
}

static void nobody_is_no_visit(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    rig_show_unusable(rig, ISO_CAPTURE_NO_FACE, 20);
    rig_run(rig, 60000);
    assert_string_equal(rig_news(rig), "");
}

/* ---- hints ---- */

static void gives_hints_at_the_door(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show_unusable(rig, ISO_CAPTURE_TOO_FAR, 2); /* a person walks in: too short for a hint */
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "");
    rig_show_unusable(rig, ISO_CAPTURE_TURN_LEFT, 40);
    rig_run(rig, 1400);
    assert_string_equal(rig_news(rig), "hint turn-left; hint turn-left"); /* one hint each second */
    rig_show(rig, 50, 2);
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
    rig_show_unusable(rig, ISO_CAPTURE_TURN_LEFT, 20); /* an admitted person may look anywhere */
    rig_run(rig, 1000);
    assert_string_equal(rig_news(rig), "");
}

static void nobody_does_not_delay_a_hint(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    rig_show_unusable(rig, ISO_CAPTURE_NO_FACE, 8);
    rig_run(rig, 300);
    rig_show_unusable(rig, ISO_CAPTURE_TOO_CLOSE, 6);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "hint too-close");
}

/* ---- motion and tracks ---- */

static void a_face_that_moves_is_not_used(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    for (int i = 0; i < 10; i++) { /* 600 mm/s; the first frame has no speed */
        rig_show_at(rig, 50, -200 + 20 * i, 33 * (i + 1));
    }
    rig_run(rig, 400);
    assert_string_equal(rig_news(rig), "hint moving");
    rig_show_at(rig, 50, -20, 10);
    rig_show_at(rig, 50, -19, 43);
    rig_run(rig, 50);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

static void two_faces_in_turn_do_not_agree(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    for (int i = 0; i < 4; i++) {
        rig_show_at(rig, 50, i % 2 ? 150 : -150, 33 * (i + 1));
    }
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "visit deny left 1; visit deny left 1; visit deny left 1");
    rig_show_at(rig, 50, 150, 10);
    rig_run(rig, 50);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

/* ---- the view ---- */

static void sends_the_view_to_a_client_that_aims(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    assert_null(iso_appliance_status(rig->appliance).view);
    rig_show_unusable(rig, ISO_CAPTURE_NO_FACE, 10);
    rig_run(rig, 400);
    assert_string_equal(rig_news(rig), ""); /* no client listens */
    assert_int_equal(iso_appliance_status(rig->appliance).view->capture, ISO_CAPTURE_NO_FACE);
    iso_appliance_aim(rig->appliance, true);
    rig_show_at(rig, 50, 30, 10);
    rig_show_at(rig, 50, 31, 50); /* less than 100 ms after the previous one */
    rig_show_at(rig, 50, 32, 120);
    rig_run(rig, 150);
    assert_string_equal(rig_news(rig), "view ok; view ok");
    const struct iso_view *view = iso_appliance_status(rig->appliance).view;
    assert_true(view->right_mm == 32 && view->distance_mm == 700);
    assert_true(view->mm_s > 14 && view->mm_s < 15);
    iso_appliance_aim(rig->appliance, false);
    rig_show_at(rig, 50, 32, 200);
    rig_run(rig, 250);
    assert_string_equal(rig_news(rig), "");
    for (int i = 0; i < 2; i++) { /* a client that begins to aim need not wait for those 100 ms */
        iso_appliance_aim(rig->appliance, true);
        rig_show_at(rig, 50, 32, 10);
        rig_run(rig, 20);
        assert_non_null(strstr(rig_news(rig), "view ok"));
        iso_appliance_aim(rig->appliance, false);
    }
}

/* ---- more visits ---- */

static void two_people_one_after_the_other(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_enrol(rig, "bob", 80);
    rig_start(rig);
    rig_show(rig, 50, 2);
    rig_run(rig, 3000);
    rig_show(rig, 81, 2);
    rig_run(rig, 3000);
    assert_string_equal(rig_news(rig),
                        "door unlocked grant; visit allow anna match 2; visit allow bob match 2");
}

/* The times of a visit are those at which its frames were exposed, however late the appliance works
 * on them (unless they are too old, see stale_ms). */
static void a_slow_machine_sees_one_visit(void **state)
{
    struct rig *rig = *state;
    rig->config.sensor.stale_ms = rig->config.sensor.pause_ms = 5000;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 50, 2);
    for (int i = 0; i < 2; i++) {
        rig->now_ns += 2 * ISO_NS_PER_S;
        (void)iso_appliance_step(rig->appliance);
    }
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

static void the_time_of_validity_counts(void **state)
{
    static const struct {
        int64_t from_s, until_s;
        bool clock_set;
        const char *news;
    } cases[] = {
        {0, 0, true, "door unlocked grant; visit allow anna match 2"},
        {0, 0, false, "door unlocked grant; visit allow anna match 2"},
        {1795249000, 1795260000, true, "door unlocked grant; visit allow anna match 2"},
        {1795249000, 0, true, "door unlocked grant; visit allow anna match 2"},
        {1795260000, 0, true, "visit deny anna not-valid 2"},
        {0, 1795249000, true, "visit deny anna not-valid 2"},
        {0, 1795260000, false, "visit deny anna not-valid 2"}, /* a clock that was never set */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        void *own = NULL;
        assert_int_equal(rig_setup(&own), 0);
        struct rig *rig = own;
        struct iso_person anna = {
            .name = "anna", .valid_from_s = cases[i].from_s, .valid_until_s = cases[i].until_s};
        const struct iso_template tmpl = puppet_template(50, PUPPET_ALGORITHM);
        rig->wall_ns = cases[i].clock_set ? rig->wall_ns : 5 * ISO_NS_PER_S;
        assert_int_equal(iso_gallery_add(rig->gallery, &anna, &tmpl, NULL), 0);
        rig_start(rig);
        rig_show(rig, 50, 2);
        rig_run(rig, 200);
        assert_string_equal(rig_news(rig), cases[i].news);
        assert_int_equal(rig_teardown(&own), 0);
    }
    (void)state;
}

/* ---- the door ---- */

static void puts_the_door_on_record(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    assert_int_equal(iso_door_null_set_input(rig->door_io, ISO_DOOR_CONTACT, true), 0);
    rig_run(rig, 60);
    assert_string_equal(rig_news(rig), "door forced opened");
    assert_non_null(strstr(rig_record(rig, "door"),
                           "\"event\":\"door\",\"reason\":\"opened\",\"note\":\"forced\"}"));
}

static void sends_the_card_of_an_admitted_person(void **state)
{
    struct rig *rig = *state;
    const char *path = scratch_path(rig->directory, "cards");
    struct iso_cards *cards = NULL;
    struct iso_wiegand_card card = {0, 0};
    size_t count = 4711;
    scratch_write_text(path, "17 4711 anna\n");
    assert_int_equal(iso_cards_load(path, &cards, NULL), 0);
    rig->borrowed.cards = cards;
    iso_appliance_free(rig->appliance);
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    rig_enrol(rig, "anna", 50);
    rig_enrol(rig, "bob", 80);
    rig_start(rig);
    rig_show(rig, 10, 6); /* a stranger */
    rig_run(rig, 20000);
    assert_int_equal(iso_door_null_get_card(rig->door_io, &count, &card), 0);
    assert_int_equal(count, 0);
    rig_show(rig, 50, 2);
    rig_run(rig, 20000);
    assert_int_equal(iso_door_null_get_card(rig->door_io, &count, &card), 0);
    assert_int_equal(count, 1);
    assert_int_equal(card.facility, 17);
    assert_int_equal(card.number, 4711);
    rig_show(rig, 80, 2); /* bob is admitted, and has no card number */
    rig_run(rig, 100);
    assert_true(rig_relay(rig));
    assert_int_equal(iso_door_null_get_card(rig->door_io, &count, &card), 0);
    assert_int_equal(count, 1);
    rig->borrowed.cards = NULL;
    iso_cards_free(cards);
}

static void stops_without_power(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 50, 2);
    rig_run(rig, 100);
    assert_true(rig_relay(rig));
    iso_appliance_stop(rig->appliance);
    assert_false(rig_relay(rig));
    assert_int_equal(rig->sensor.closed, 1);
    assert_string_not_equal(rig_record(rig, "stop"), "");
    assert_non_null(strstr(rig_record(rig, "start"), "\"sequence\":1,"));
}

static void knows_its_state(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    rig_show(rig, 50, 1);
    rig_run(rig, 250);
    const struct iso_appliance_status status = iso_appliance_status(rig->appliance);
    assert_int_equal(status.mode, ISO_APPLIANCE_WATCH);
    assert_string_equal(iso_appliance_mode_name(status.mode), "watch");
    assert_int_equal(status.door, ISO_DOOR_LOCKED);
    assert_string_equal(status.sensor_model, "puppet9");
    assert_int_equal(status.frames, 1);
    assert_int_equal(status.model, PUPPET_MODEL);
    assert_int_equal(status.algorithm, PUPPET_ALGORITHM);
    assert_int_equal(status.uptime_ns, 250 * ISO_NS_PER_MS);
    assert_true(iso_appliance_door_fd(rig->appliance) >= 0);
    assert_int_equal(iso_appliance_sensor_fd(rig->appliance), -ENOSYS);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, rig_setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(admits_a_known_person),
        TEST(refuses_a_stranger),
        TEST(refuses_a_person_who_leaves),
        TEST(refuses_everybody_with_an_empty_gallery),
        TEST(nobody_is_no_visit),
        TEST(gives_hints_at_the_door),
        TEST(nobody_does_not_delay_a_hint),
        TEST(a_face_that_moves_is_not_used),
        TEST(two_faces_in_turn_do_not_agree),
        TEST(sends_the_view_to_a_client_that_aims),
        TEST(two_people_one_after_the_other),
        TEST(a_slow_machine_sees_one_visit),
        cmocka_unit_test(the_time_of_validity_counts),
        TEST(puts_the_door_on_record),
        TEST(sends_the_card_of_an_admitted_person),
        TEST(stops_without_power),
        TEST(knows_its_state),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
