/* A verdict and the door's result for it are two facts. Both are recorded and reported. The door is
 * the null back end behind outputs that can get stuck. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_null.h"
#include "firmware/door/cards.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/support/devices/manual_clock.h"
#include "tests/support/scratch.h"

static struct rig *the_rig;
static bool stuck[ISO_DOOR_OUTPUTS], contact, disk_fills, blind;
static bool relay;          /* the last switched state */
static char at_relay[1024]; /* the last "grant" record when the relay was switched on */

static int set_output(void *self, enum iso_door_output output, bool active, struct iso_fault *fault)
{
    if (stuck[output]) {
        return iso_fault_set(fault, -EIO, "output %d is stuck", output);
    }
    if (output == ISO_DOOR_RELAY) {
        relay = active;
        if (active) {
            (void)snprintf(at_relay, sizeof at_relay, "%s", rig_record(the_rig, "grant"));
            if (disk_fills) {
                rig_fill_disk();
            }
        }
    }
    return iso_door_null_ops.set_output(self, output, active, fault);
}

static int get_inputs(void *self, struct iso_door_inputs *out, struct iso_fault *fault)
{
    const int error = blind ? iso_fault_set(fault, -EIO, "the contact is cut")
                            : iso_door_null_ops.get_inputs(self, out, fault);
    if (!error) {
        out->active[ISO_DOOR_CONTACT] |= contact;
    }
    return error;
}

static int setup(void **state)
{
    static struct iso_door_io_ops ops;
    static const struct iso_door_outputs unpowered;
    if (rig_setup(state)) {
        return -1;
    }
    struct rig *rig = the_rig = *state;
    const struct iso_clock clock = manual_clock(&rig->now_ns);
    ops = iso_door_null_ops;
    ops.name = "sticky";
    ops.set_output = set_output;
    ops.get_inputs = get_inputs;
    memset(stuck, 0, sizeof stuck);
    contact = disk_fills = blind = relay = false;
    at_relay[0] = '\0';
    iso_appliance_free(rig->appliance);
    iso_door_io_close(rig->door_io);
    assert_int_equal(iso_door_io_open_ops(&ops, NULL, 0, &clock, &unpowered, &rig->door_io, NULL),
                     0);
    rig->borrowed.door_io = rig->door_io;
    rig_enrol(rig, "anna", 50);
    return iso_appliance_new(&rig->borrowed, &rig->appliance);
}

/* Anna stands at the door long enough for a verdict. */
static void come(struct rig *rig)
{
    rig_show(rig, 50, 2);
    rig_run(rig, 100);
}

static uint64_t number_in(const char *record, const char *key)
{
    char member[32];
    (void)snprintf(member, sizeof member, "\"%s\":", key);
    const char *at = strstr(record, member);
    assert_non_null(at);
    return strtoull(at + strlen(member), NULL, 10);
}

static void a_grant_is_on_record_before_the_lock_and_its_outcome_after(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    come(rig);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
    assert_true(relay);
    assert_non_null(strstr(at_relay, "\"person\":\"anna\",\"verdict\":\"allow\",\"reason\":"
                                     "\"match\""));
    assert_null(strstr(at_relay, "\"door\"")); /* the result is not known yet */
    const char *visit = rig_record(rig, "visit");
    assert_non_null(strstr(visit, "\"verdict\":\"allow\",\"door\":\"unlocked\",\"grant\":"));
    assert_null(strstr(visit, "door_fault"));
    assert_int_equal(number_in(visit, "grant"), number_in(at_relay, "sequence"));
    assert_string_equal(iso_appliance_status(rig->appliance).last_outcome, "allow anna");
}

/* On such a door the controller unlocks. It needs a card number. */
static void a_door_without_a_relay_needs_a_card_number(void **state)
{
    struct rig *rig = *state;
    const char *path = scratch_path(rig->directory, "cards");
    struct iso_cards *cards = NULL;
    scratch_write_text(path, "17 4711 bob\n");
    assert_int_equal(iso_cards_load(path, &cards, NULL), 0);
    rig->borrowed.cards = cards;
    static const struct iso_option_spec d0 = {.name = "wiegand_d0", .kind = ISO_OPTION_LINE};
    rig->config.door.options = (struct iso_config_options){.n = 1, .list = {{&d0, "D0", 0}}};
    iso_appliance_free(rig->appliance);
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    rig_start(rig);
    come(rig);
    assert_non_null(strstr(rig_record(rig, "visit"),
                           "\"verdict\":\"allow\",\"door\":\"not-unlocked\","
                           "\"door_fault\":\"the admitted person has no card number\""));
    rig->borrowed.cards = NULL;
    iso_cards_free(cards);
}

static void a_refusal_does_not_use_the_door(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    rig_show(rig, 90, 6);
    rig_run(rig, 300);
    assert_string_equal(rig_news(rig), "visit deny unknown 6");
    assert_string_equal(rig_record(rig, "grant"), "");
    assert_null(strstr(rig_record(rig, "visit"), "\"door\""));
}

static void an_allowed_visit_with_a_stuck_lock_does_not_unlock(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    stuck[ISO_DOOR_RELAY] = true;
    come(rig);
    assert_string_equal(rig_news(rig), "door fault fault; "
                                       "visit allow anna match 2 not-unlocked: output 0 is stuck");
    assert_non_null(strstr(rig_record(rig, "visit"),
                           "\"verdict\":\"allow\",\"door\":\"not-unlocked\","
                           "\"door_fault\":\"output 0 is stuck\",\"grant\":"));
    assert_string_equal(iso_appliance_status(rig->appliance).last_outcome,
                        "allow anna, door not-unlocked");
    /* The record stays true: the lock does not open when its line works again. */
    stuck[ISO_DOOR_RELAY] = false;
    rig_run(rig, 1000);
    assert_string_equal(rig_news(rig), "door locked recovered");
    assert_false(relay);
    rig_run(rig, 5000);
    come(rig);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
    assert_true(relay);
}

/* The lock decides the result, not the lamp. */
static void a_door_whose_lamp_is_stuck_unlocks_all_the_same(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    stuck[ISO_DOOR_LED_GRANTED] = true;
    come(rig);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
    assert_true(relay);
    assert_non_null(strstr(rig_record(rig, "visit"), "\"door\":\"unlocked\""));
}

static void a_door_that_is_at_fault_already_says_why(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    blind = true;
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "door fault fault");
    come(rig);
    assert_string_equal(rig_news(rig), "visit allow anna match 2 not-unlocked: the contact is cut");
    assert_false(relay);
    assert_non_null(strstr(rig_record(rig, "visit"), "\"door_fault\":\"the contact is cut\""));
}

static void a_door_that_stands_open_is_not_unlocked_again(void **state)
{
    struct rig *rig = *state;
    contact = true;
    rig_start(rig);
    come(rig);
    assert_string_equal(rig_news(rig), "visit allow anna match 2");
    assert_false(relay);
    assert_non_null(strstr(rig_record(rig, "visit"), "\"verdict\":\"allow\",\"door\":\"open\""));
}

/* The grant is on the disk, so the door opens. The full disk afterwards does not lock it. */
static void a_disk_that_fills_behind_the_grant_keeps_nobody_out(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    disk_fills = true;
    come(rig);
    rig_free_disk();
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
    assert_true(relay);
    assert_string_equal(rig_record(rig, "visit"), "");
    assert_non_null(strstr(rig_record(rig, "grant"), "\"person\":\"anna\""));
}

static void a_grant_that_cannot_be_written_is_refused(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    rig_fill_disk();
    come(rig);
    rig_free_disk();
    assert_string_equal(rig_news(rig), "visit deny anna unlogged 2");
    assert_false(relay);
    assert_string_equal(rig_record(rig, "grant"), "");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_grant_is_on_record_before_the_lock_and_its_outcome_after),
        TEST(a_refusal_does_not_use_the_door),
        TEST(an_allowed_visit_with_a_stuck_lock_does_not_unlock),
        TEST(a_door_whose_lamp_is_stuck_unlocks_all_the_same),
        TEST(a_door_without_a_relay_needs_a_card_number),
        TEST(a_door_that_is_at_fault_already_says_why),
        TEST(a_door_that_stands_open_is_not_unlocked_again),
        TEST(a_disk_that_fills_behind_the_grant_keeps_nobody_out),
        TEST(a_grant_that_cannot_be_written_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
