/* The appliance at the door: visits, sensor, lines, log. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_null.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/support/scratch.h"

/* ---- visits ---- */

static void lets_in_who_is_known(void **state)
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

static void refuses_who_leaves(void **state)
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

static void says_at_the_door_what_hinders(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show_unusable(rig, ISO_CAPTURE_TOO_FAR, 2); /* walks in: too short to be said */
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "");
    rig_show_unusable(rig, ISO_CAPTURE_TURN_LEFT, 40);
    rig_run(rig, 1400);
    assert_string_equal(rig_news(rig), "hint turn-left; hint turn-left"); /* once a second */
    rig_show(rig, 50, 2);
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
    rig_show_unusable(rig, ISO_CAPTURE_TURN_LEFT, 20); /* who is let in may look where he goes */
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

/* ---- attacks ---- */

static void an_attack_is_denied_counted_and_on_record(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show_unusable(rig, ISO_CAPTURE_SCREEN, 1);
    rig_run(rig, 40);
    rig_show_unusable(rig, ISO_CAPTURE_FLAT, 5);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "visit deny attack 0");
    assert_non_null(
        strstr(rig_record(rig, "visit"),
               "\"verdict\":\"deny\",\"reason\":\"attack\",\"threshold\":6,"
               "\"frames\":0,\"attack_frames\":2,\"sensor\":\"started\",\"note\":\"flat\"}"));
    assert_string_equal(rig_record(rig, "attack"), ""); /* it goes on, for all that is known */
    rig_run(rig, 10000);
    assert_non_null(strstr(rig_record(rig, "attack"), "\"reason\":\"flat\",\"attack_frames\":6,"
                                                      "\"note\":\"within 0.2 s\"}"));
    const struct iso_appliance_counts counts = iso_appliance_status(rig->appliance).counts;
    assert_int_equal(counts.allowed, 0);
    assert_int_equal(counts.denied, 1);
    assert_int_equal(counts.attacks, 1);
    assert_int_equal(counts.attack_frames, 6);
    rig_show(rig, 50, 2);
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
    assert_int_equal(iso_appliance_status(rig->appliance).counts.allowed, 1);
}

static void a_single_cue_is_on_record_and_delays_nobody(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show_unusable(rig, ISO_CAPTURE_BENT, 1);
    rig_run(rig, 40);
    rig_show(rig, 50, 2);
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
    assert_non_null(strstr(rig_record(rig, "visit"), "\"frames\":2,\"attack_frames\":1,"
                                                     "\"sensor\":\"started\",\"note\":\"bent\"}"));
    iso_appliance_stop(rig->appliance); /* before the attempt is over: not forgotten */
    assert_non_null(strstr(rig_record(rig, "attack"), "\"reason\":\"bent\",\"attack_frames\":1,"));
}

/* The puppets' frames are the same to the bit, as if one were played again and again. */
static void frames_that_repeat_are_an_attack(void **state)
{
    struct rig *rig = *state;
    rig->config.motion.frozen_frames = 3;
    rig->config.decision.agree = 6;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    for (int i = 0; i < 6; i++) {
        rig_show_at(rig, 50, 0, 33 * (i + 1));
    }
    rig_run(rig, 250);
    const char *news = rig_news(rig);
    assert_non_null(strstr(news, "visit deny attack"));
    assert_null(strstr(news, "allow"));
}

/* ---- motion and tracks ---- */

static void a_face_that_moves_is_not_used(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    for (int i = 0; i < 10; i++) { /* 600 mm/s, and of the first frame nobody knows */
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

static void tells_what_it_sees_to_who_aims(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    assert_null(iso_appliance_status(rig->appliance).view);
    rig_show_unusable(rig, ISO_CAPTURE_NO_FACE, 10);
    rig_run(rig, 400);
    assert_string_equal(rig_news(rig), ""); /* nobody listens */
    assert_int_equal(iso_appliance_status(rig->appliance).view->capture, ISO_CAPTURE_NO_FACE);
    iso_appliance_aim(rig->appliance, true);
    rig_show_at(rig, 50, 30, 10);
    rig_show_at(rig, 50, 31, 50); /* not sooner than 100 ms after */
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
    for (int i = 0; i < 2; i++) { /* whoever begins to aim need not wait for those 100 ms */
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

/* Late as frames are worked on (if not too late, see stale_ms), it is their exposure that counts.
 */
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

static void what_cannot_be_logged_does_not_open(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 50, 2);
    rig_fill_disk();
    rig_run(rig, 2500);
    rig_free_disk();
    assert_string_equal(rig_news(rig), "visit deny anna unlogged 2");
    assert_false(rig_relay(rig));
    rig_show(rig, 50, 2);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

static void who_is_inside_gets_out_with_a_full_disk(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    rig_fill_disk();
    assert_int_equal(iso_door_null_set_input(rig->door_io, ISO_DOOR_EXIT_BUTTON, true), 0);
    rig_run(rig, 100);
    rig_free_disk();
    assert_string_equal(rig_news(rig), "door unlocked exit-button");
    assert_true(rig_relay(rig));
}

/* ---- frames that cannot be worked on ---- */

static void goes_on_after_a_frame_that_fails(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 50, 4);
    rig->puppet.extract_error = -EDOM;
    rig_run(rig, 40);
    rig->puppet.extract_error = 0;
    rig->puppet.search_error = -ENOMEM;
    rig_run(rig, 33);
    rig->puppet.search_error = 0;
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

static void a_face_with_too_few_points_is_none(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig->puppet.search_error = -ENODATA;
    rig_show(rig, 50, 6);
    rig_run(rig, 5000);
    assert_string_equal(rig_news(rig), "hint too-few-points");
}

/* ---- the sensor ---- */

static void a_lost_sensor_is_a_fault_of_the_door(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 50, 1);
    rig_run(rig, 100);
    rig->sensor.wait_error = rig->sensor.open_error = -ENODEV;
    rig_run(rig, 2000);
    assert_string_equal(rig_news(rig), "door fault fault"); /* and the visit is forgotten */
    assert_non_null(strstr(rig_record(rig, "sensor"), "\"reason\":\"lost\""));
    assert_string_equal(iso_appliance_status(rig->appliance).sensor_state, "lost");
    assert_string_equal(iso_appliance_status(rig->appliance).sensor_fault, "puppet: will not open");
    rig->sensor.wait_error = rig->sensor.open_error = 0;
    rig_run(rig, 30000);
    assert_string_equal(rig_news(rig), "door locked recovered");
    rig_show(rig, 50, 2);
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

static void starts_without_a_sensor(void **state)
{
    struct rig *rig = *state;
    rig->sensor.open_error = -ENODEV;
    assert_int_equal(iso_appliance_start(rig->appliance, NULL), 0);
    assert_string_equal(rig_news(rig), "door locked start; door fault fault");
    rig->sensor.open_error = 0;
    rig_run(rig, 1000);
    assert_string_equal(rig_news(rig), "door locked recovered");
}

static void does_not_start_with_a_sensor_that_cannot_be(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    rig->sensor.open_error = -EINVAL;
    assert_int_equal(iso_appliance_start(rig->appliance, &fault), -EINVAL);
    assert_string_equal(fault.text, "puppet: will not open");
}

static void a_damaged_frame_is_no_fault_of_the_door(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    rig->sensor.wait_error = -EBADMSG;
    (void)iso_appliance_step(rig->appliance);
    assert_string_equal(rig_news(rig), "");
    rig->sensor.wait_error = 0;
    rig_run(rig, 100);
    assert_string_equal(iso_appliance_status(rig->appliance).sensor_state, "started");
}

/* The camera hiccups: within a second nobody is let in for what was seen before, and it is not
 * opened anew. */
static void a_silent_sensor_is_a_fault_of_the_door_within_a_second(void **state)
{
    struct rig *rig = *state;
    rig->sensor.streams = true;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 50, 1);
    rig_run(rig, 33 + 890);
    assert_string_equal(rig_news(rig), "");
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "door fault fault");
    assert_false(rig_relay(rig));
    assert_string_equal(iso_appliance_status(rig->appliance).sensor_state, "silent");
    assert_non_null(strstr(rig_record(rig, "sensor"), "\"reason\":\"silent\""));
    assert_non_null(strstr(rig_record(rig, "sensor"), "nothing seen for 9"));
    rig_run(rig, 200);
    rig_show(rig, 50, 1); /* one of two that would have agreed */
    rig_run(rig, 50);
    assert_string_equal(rig_news(rig), "door locked recovered");
    assert_string_equal(iso_appliance_status(rig->appliance).sensor_state, "started");
    assert_int_equal(rig->sensor.opened, 1);
    rig_show(rig, 50, 1);
    rig_run(rig, 50);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

/* A client's enrolment outlives it. */
static void an_action_goes_on_after_a_pause(void **state)
{
    struct rig *rig = *state;
    const struct iso_enroll_request anna = {.person = "anna"};
    rig->sensor.streams = true;
    rig_start(rig);
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    assert_int_equal(iso_appliance_enroll(rig->appliance, &anna, NULL), 0);
    rig_run(rig, 1200);
    assert_string_equal(rig_news(rig), "door fault fault");
    assert_int_equal(iso_appliance_status(rig->appliance).mode, ISO_APPLIANCE_ENROLL);
    rig_run(rig, 5000); /* and is lost with the sensor */
    assert_string_equal(rig_news(rig), "enroll disconnected 0/3 done");
}

static void the_watchdog_sees_an_idle_sensor_and_not_a_dead_one(void **state)
{
    struct rig *rig = *state;
    rig->sensor.streams = true;
    rig->config.sensor.silence_ms = 600000;
    rig_start(rig);
    const uint64_t dead = iso_appliance_progress(rig->appliance);
    rig_run(rig, 60000);
    assert_int_equal(iso_appliance_progress(rig->appliance), dead);
    rig_show(rig, 50, 1);
    rig_run(rig, 100);
    assert_int_equal(iso_appliance_progress(rig->appliance), dead + 1);
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

static void sends_the_card_of_who_is_let_in(void **state)
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
    rig_show(rig, 80, 2); /* bob has none, and is let in */
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
        TEST(lets_in_who_is_known),
        TEST(refuses_a_stranger),
        TEST(refuses_who_leaves),
        TEST(refuses_everybody_with_an_empty_gallery),
        TEST(nobody_is_no_visit),
        TEST(says_at_the_door_what_hinders),
        TEST(nobody_does_not_delay_a_hint),
        TEST(an_attack_is_denied_counted_and_on_record),
        TEST(a_single_cue_is_on_record_and_delays_nobody),
        TEST(frames_that_repeat_are_an_attack),
        TEST(a_face_that_moves_is_not_used),
        TEST(two_faces_in_turn_do_not_agree),
        TEST(tells_what_it_sees_to_who_aims),
        TEST(two_people_one_after_the_other),
        TEST(a_slow_machine_sees_one_visit),
        cmocka_unit_test(the_time_of_validity_counts),
        TEST(what_cannot_be_logged_does_not_open),
        TEST(who_is_inside_gets_out_with_a_full_disk),
        TEST(goes_on_after_a_frame_that_fails),
        TEST(a_face_with_too_few_points_is_none),
        TEST(a_lost_sensor_is_a_fault_of_the_door),
        TEST(starts_without_a_sensor),
        TEST(does_not_start_with_a_sensor_that_cannot_be),
        TEST(a_damaged_frame_is_no_fault_of_the_door),
        TEST(a_silent_sensor_is_a_fault_of_the_door_within_a_second),
        TEST(an_action_goes_on_after_a_pause),
        TEST(the_watchdog_sees_an_idle_sensor_and_not_a_dead_one),
        TEST(puts_the_door_on_record),
        TEST(sends_the_card_of_who_is_let_in),
        TEST(stops_without_power),
        TEST(knows_its_state),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
