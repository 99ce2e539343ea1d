/* What the policy wants besides a face: a card, a PIN, a second person. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/wiegand.h"
#include "tests/firmware/appliance/access_rig.h"

/* ---- more than a face ---- */

static void a_card_follows_a_face(void **state)
{
    struct rig *rig = *state;
    access_rig_start(
        rig, access_rig_always("\"recognition_groups\": [[\"face\", \"card\"]]", false, ""));
    access_rig_set_credential(rig, "anna", "{\"cards\": [\"17/4711\", \"56:04a2b3c4d5e6f7\"]}");
    access_rig_look(rig, ACCESS_ANNA);
    access_rig_expect(rig_news(rig), "wanted card");
    assert_false(rig_relay(rig));
    access_rig_show_card(rig, "56:04a2b3c4d5e6f7");
    access_rig_expect(rig_news(rig), "visit allow anna match");
    assert_true(rig_relay(rig));
    rig_run(rig, 20000);
    (void)rig_news(rig);

    access_rig_expect_visit(rig, ACCESS_BEN,
                            "visit deny ben not-here"); /* ben has no card, so he can never pass */
    rig_run(rig, 20000);
    (void)rig_news(rig);

    access_rig_look(rig, ACCESS_ANNA);
    access_rig_expect(rig_news(rig), "wanted card");
    access_rig_show_card(rig, "17/4712");
    access_rig_expect(rig_news(rig), "visit deny anna wrong-factor");
    assert_false(rig_relay(rig));
}

static void who_does_not_show_more_is_refused(void **state)
{
    struct rig *rig = *state;
    access_rig_start(
        rig, access_rig_always("\"recognition_groups\": [[\"face\", \"card\"]]", false, ""));
    access_rig_set_credential(rig, "anna", "{\"cards\": [\"17/4711\"]}");
    access_rig_look(rig, ACCESS_ANNA);
    access_rig_expect(rig_news(rig), "wanted card");
    rig_run(rig, 14000);
    assert_null(strstr(rig_news(rig), "visit"));
    rig_run(rig, 2000);
    access_rig_expect(rig_news(rig), "visit deny anna not-enough");
    access_rig_show_card(rig, "17/4711"); /* too late: the card alone begins anew */
    access_rig_expect(rig_news(rig), "wanted face");
    assert_false(rig_relay(rig));
}

/* After a card a face is compared with its holder alone, and a stolen card is of no use. */
static void a_face_follows_a_card(void **state)
{
    struct rig *rig = *state;
    access_rig_start(
        rig, access_rig_always("\"recognition_groups\": [[\"face\", \"card\"]]", false, ""));
    access_rig_set_credential(rig, "anna", "{\"cards\": [\"17/4711\"]}");
    access_rig_show_card(rig, "17/4711");
    access_rig_expect(rig_news(rig), "wanted face");
    access_rig_look(rig, ACCESS_ANNA);
    access_rig_expect(rig_news(rig), "visit allow anna match");
    rig_run(rig, 30000);
    (void)rig_news(rig);
    access_rig_show_card(rig, "17/4711");
    rig_show(rig, ACCESS_BEN, 30);
    rig_run(rig, 1100);
    const char *news = rig_news(rig);
    access_rig_expect(news, "visit deny");
    assert_null(strstr(news, "allow"));
    assert_false(rig_relay(rig));
    rig_run(rig, 30000);
    (void)rig_news(rig);
    access_rig_show_card(rig, "17/9999");
    access_rig_expect(rig_news(rig), "visit deny unknown");
}

static void a_pin_follows_a_face(void **state)
{
    struct rig *rig = *state;
    access_rig_start(rig,
                     access_rig_always("\"recognition_groups\": [[\"face\", \"pin\"]]", false, ""));
    access_rig_set_credential(rig, "anna", "{\"pin\": \"0042\", \"duress_pin\": \"0911\"}");
    access_rig_look(rig, ACCESS_ANNA);
    access_rig_expect(rig_news(rig), "wanted pin");
    access_rig_type(rig, "99*0042");
    assert_string_equal(rig_news(rig), "");
    access_rig_type(rig, "#");
    access_rig_expect(rig_news(rig), "visit allow anna match");
    assert_string_equal(rig_record(rig, "duress"), "");
    rig_run(rig, 30000);
    (void)rig_news(rig);

    access_rig_look(rig, ACCESS_ANNA);
    access_rig_type(rig, "1234#");
    access_rig_expect(rig_news(rig), "visit deny anna wrong-factor");
    rig_run(rig, 30000);
    (void)rig_news(rig);

    access_rig_look(rig, ACCESS_ANNA);
    access_rig_type(rig, "0911#");
    const char *news = rig_news(rig);
    access_rig_expect(news, "visit allow anna match");
    assert_null(strstr(news, "duress"));
    access_rig_expect(rig_record(rig, "duress"), "\"person\":\"anna\"");
}

/* Wrong PINs count as failures, so that nobody can try them all. */
static void guessing_a_pin_locks_the_door(void **state)
{
    struct rig *rig = *state;
    access_rig_start(rig,
                     access_rig_always("\"recognition_groups\": [[\"card\", \"pin\"]]", false, ""));
    access_rig_set_credential(rig, "anna", "{\"cards\": [\"17/4711\"], \"pin\": \"2580\"}");
    for (int i = 0; i < 5; i++) {
        access_rig_show_card(rig, "17/4711");
        access_rig_expect(rig_news(rig), "wanted pin");
        access_rig_type(rig, "1234#");
        access_rig_expect(rig_news(rig), "visit deny anna wrong-factor");
    }
    access_rig_show_card(rig, "17/4711");
    access_rig_type(rig, "2580#");
    assert_string_equal(rig_news(rig), "");
    assert_false(rig_relay(rig));
    rig_run(rig, 31000);
    (void)rig_news(rig);
    access_rig_show_card(rig, "17/4711");
    access_rig_type(rig, "2580#");
    access_rig_expect(rig_news(rig), "visit allow anna credential");
    assert_true(rig_relay(rig));
}

static void two_people_come_together(void **state)
{
    struct rig *rig = *state;
    access_rig_start(rig, access_rig_always("\"recognition_groups\": [[\"face\"]]", true, ""));
    access_rig_look(rig, ACCESS_ANNA);
    access_rig_expect(rig_news(rig), "wanted person");
    rig_run(rig, 2000);
    access_rig_look(rig, ACCESS_BEN);
    access_rig_expect(rig_news(rig), "visit allow anna match");
    access_rig_expect(rig_record(rig, "grant"), "with ben");
    rig_run(rig, 30000);
    (void)rig_news(rig);
    access_rig_set_credential(rig, "anna", "{\"needs_escort\": true}");
    access_rig_set_credential(rig, "ben", "{\"needs_escort\": true}");
    access_rig_look(rig, ACCESS_ANNA);
    rig_run(rig, 2000);
    access_rig_look(rig, ACCESS_BEN);
    access_rig_expect(rig_news(rig), "no-pair");
    assert_false(rig_relay(rig));
}

/* A card alone counts only while the camera does not work, and only if the site wants it. */
static void a_card_replaces_a_camera_at_fault(void **state)
{
    struct rig *rig = *state;
    access_rig_start(rig, access_rig_always("\"recognition_groups\": [[\"face\"]]", false, ""));
    access_rig_set_credential(rig, "anna", "{\"cards\": [\"17/4711\"], \"pin\": \"2580\"}");
    access_rig_set_credential(rig, "ben", "{\"cards\": [\"17/4712\"]}");
    rig->config.policy.card_alone = true;
    access_rig_show_card(rig, "17/4712");
    access_rig_expect(rig_news(rig), "wanted face");
    rig_run(rig, 20000);
    rig->sensor.open_error = rig->sensor.wait_error = -ENODEV;
    rig_run(rig, 2000);
    (void)rig_news(rig);
    access_rig_show_card(rig, "17/4712");
    access_rig_expect(rig_news(rig), "ben credential");
    rig_run(rig, 20000);
    (void)rig_news(rig);
    access_rig_show_card(rig, "17/4711");
    access_rig_expect(rig_news(rig), "wanted pin");
    access_rig_type(rig, "2580#");
    access_rig_expect(rig_news(rig), "anna credential");
}

/* A wait ends on record whatever ends it: a camera that is lost, a client, a lockdown. */
static void a_wait_that_is_cut_short_is_on_record(void **state)
{
    struct rig *rig = *state;
    access_rig_start(
        rig, access_rig_always("\"recognition_groups\": [[\"face\", \"card\"]]", false, ""));
    access_rig_set_credential(rig, "anna", "{\"cards\": [\"17/4711\"]}");
    access_rig_look(rig, ACCESS_ANNA);
    access_rig_expect(rig_news(rig), "wanted card");
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    access_rig_expect(rig_news(rig), "visit deny anna not-enough");
    iso_appliance_release(rig->appliance);
    rig_run(rig, 20000);
    (void)rig_news(rig);
    access_rig_look(rig, ACCESS_ANNA);
    access_rig_expect(rig_news(rig), "wanted card");
    assert_int_equal(iso_appliance_lockdown(rig->appliance, true, NULL), 0);
    access_rig_expect(rig_news(rig), "visit deny lockdown");
    assert_int_equal(iso_appliance_lockdown(rig->appliance, false, NULL), 0);
    access_rig_show_card(rig, "17/4711"); /* begins anew */
    access_rig_expect(rig_news(rig), "wanted face");
    assert_int_equal(iso_appliance_remove(rig->appliance, "anna", NULL), 0);
    assert_false(rig_relay(rig));
}

/* ---- what an attacker tries ---- */

/* A card in place of the face replaces the face alone, and no other rule. */
static void a_broken_camera_breaks_no_other_rule(void **state)
{
    struct rig *rig = *state;
    access_rig_start(rig, access_rig_always("\"recognition_groups\": [[\"face\"]]", true, ""));
    access_rig_set_credential(rig, "anna", "{\"cards\": [\"17/4711\"]}");
    rig->config.policy.card_alone = true;
    rig->sensor.open_error = rig->sensor.wait_error = -ENODEV;
    rig_run(rig, 2000);
    (void)rig_news(rig);
    access_rig_show_card(rig, "17/4711");
    access_rig_expect(rig_news(rig), "wanted person");
    assert_false(rig_relay(rig));
}

/* Letting oneself in between the guesses does not help. */
static void an_own_admission_forgives_no_guess(void **state)
{
    struct rig *rig = *state;
    access_rig_start(rig,
                     access_rig_always("\"recognition_groups\": [[\"card\", \"pin\"]]", false, ""));
    access_rig_set_credential(rig, "anna", "{\"cards\": [\"17/4711\"], \"pin\": \"2580\"}");
    access_rig_set_credential(rig, "ben", "{\"cards\": [\"17/4712\"], \"pin\": \"1470\"}");
    for (int i = 0; i < 4; i++) {
        access_rig_show_card(rig, "17/4711");
        access_rig_type(rig, "1234#");
        access_rig_expect(rig_news(rig), "visit deny anna wrong-factor");
    }
    access_rig_show_card(rig, "17/4712");
    access_rig_type(rig, "1470#");
    access_rig_expect(rig_news(rig), "visit allow ben credential");
    rig_run(rig, 10000);
    access_rig_show_card(rig, "17/4711");
    access_rig_type(rig, "1234#");
    (void)rig_news(rig);
    access_rig_show_card(rig, "17/4712");
    assert_string_equal(rig_news(rig), ""); /* locked out */
}

/* A stranger's card and one of another site do not lock the door. */
static void strange_cards_lock_nobody_out(void **state)
{
    struct rig *rig = *state;
    access_rig_start(rig, access_rig_always("\"recognition_groups\": [[\"face\"]]", false, ""));
    for (int i = 0; i < 10; i++) {
        access_rig_show_card(rig, "9/9999");
        access_rig_expect(rig_news(rig), "visit deny unknown");
        rig_run(rig, 1000);
    }
    rig_run(rig, 10000);
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit allow anna match");
}

/* The alarm does not depend on how the wait ends. */
static void a_duress_pin_is_told_at_once(void **state)
{
    struct rig *rig = *state;
    access_rig_start(rig,
                     access_rig_always("\"recognition_groups\": [[\"face\", \"pin\"]]", true, ""));
    access_rig_set_credential(rig, "anna", "{\"pin\": \"2580\", \"duress_pin\": \"0911\"}");
    access_rig_look(rig, ACCESS_ANNA);
    access_rig_type(rig, "0911#");
    access_rig_expect(rig_news(rig), "wanted person");
    access_rig_expect(rig_record(rig, "duress"), "\"person\":\"anna\"");
}

/* A face that is refused ends the wait for another person's card. */
static void a_refused_face_ends_the_wait(void **state)
{
    struct rig *rig = *state;
    access_rig_start(
        rig, access_rig_always("\"recognition_groups\": [[\"face\", \"card\"]]", false, ""));
    access_rig_set_credential(rig, "anna", "{\"cards\": [\"17/4711\"]}");
    access_rig_look(rig, ACCESS_ANNA);
    access_rig_expect(rig_news(rig), "wanted card");
    rig_run(rig, 9000);
    access_rig_look(rig, ACCESS_STRANGER);
    access_rig_expect(rig_news(rig), "visit deny unknown");
    access_rig_show_card(rig, "17/4711");
    access_rig_expect(rig_news(rig), "wanted face");
    assert_false(rig_relay(rig));
}

/* ---- the reader ---- */

/* A reader of a test: the events that it still has, and its fault. */
struct puppet_reader {
    struct iso_reader_event events[16];
    int first, n;
    struct iso_fault fault;
    int allowed, refused; /* what was shown */
};

static bool take_event(void *context, struct iso_reader_event *out)
{
    struct puppet_reader *reader = context;
    if (reader->first == reader->n) {
        return false;
    }
    *out = reader->events[reader->first++];
    return true;
}

static void copy_fault(void *context, struct iso_fault *out)
{
    *out = ((struct puppet_reader *)context)->fault;
}

static void count_shown(void *context, bool allow)
{
    struct puppet_reader *reader = context;
    *(allow ? &reader->allowed : &reader->refused) += 1;
}

static int no_descriptor(void *context)
{
    (void)context;
    return -1;
}

/* A card of 34 bits is the card of the same facility and number in another format. */
static void a_reader_brings_cards_and_keys(void **state)
{
    struct rig *rig = *state;
    struct puppet_reader reader = {.n = 0};
    const struct iso_wiegand_card card = {17, 4711};
    rig->borrowed.reader = (struct iso_card_source){.take = take_event,
                                                    .fault = copy_fault,
                                                    .fd = no_descriptor,
                                                    .show = count_shown,
                                                    .context = &reader};
    access_rig_start(rig, "");
    access_rig_restart(rig);
    (void)access_rig_set_policy(
        rig, access_rig_always("\"recognition_groups\": [[\"card\", \"pin\"]]", false, ""));
    access_rig_set_credential(rig, "anna", "{\"cards\": [\"17/4711\"], \"pin\": \"2580\"}");
    reader.events[reader.n].kind = ISO_READER_CARD;
    reader.events[reader.n].bits = 34;
    reader.events[reader.n].t_ns = rig->now_ns;
    assert_int_equal(iso_wiegand_encode(34, &card, &reader.events[reader.n++].code), 0);
    for (const char *key = "2580#"; *key; key++) {
        reader.events[reader.n++] = (struct iso_reader_event){
            .kind = ISO_READER_KEY, .key = *key, .t_ns = rig->now_ns};
    }
    rig_run(rig, 100);
    access_rig_expect(rig_news(rig), "visit allow anna credential");
    assert_string_equal(iso_appliance_status(rig->appliance).reader_state, "works");
    assert_int_equal(reader.allowed, 1);
    assert_int_equal(reader.refused, 0);
    /* A card of nobody. */
    reader.events[reader.n++] = (struct iso_reader_event){
        .kind = ISO_READER_CARD, .bits = 40, .code = 4711, .t_ns = rig->now_ns};
    rig_run(rig, 100);
    assert_int_equal(reader.allowed, 1);
    assert_int_equal(reader.refused, 1);
    (void)iso_fault_set(&reader.fault, -ENODEV, "the reader is gone");
    rig_run(rig, 100);
    assert_string_equal(iso_appliance_status(rig->appliance).reader_state, "lost");
    access_rig_expect(rig->warned, "the reader is gone");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, rig_setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_card_follows_a_face),
        TEST(who_does_not_show_more_is_refused),
        TEST(a_face_follows_a_card),
        TEST(a_pin_follows_a_face),
        TEST(guessing_a_pin_locks_the_door),
        TEST(two_people_come_together),
        TEST(a_card_replaces_a_camera_at_fault),
        TEST(a_wait_that_is_cut_short_is_on_record),
        TEST(a_broken_camera_breaks_no_other_rule),
        TEST(an_own_admission_forgives_no_guess),
        TEST(strange_cards_lock_nobody_out),
        TEST(a_duress_pin_is_told_at_once),
        TEST(a_refused_face_ends_the_wait),
        TEST(a_reader_brings_cards_and_keys),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
