/* An appliance with an access panel: who is let in has a card at the panel, and what happens is on
 * record. The appliance's clock is injected, the panel's time is real. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_null.h"
#include "firmware/appliance/administration/administration.h"
#include "firmware/door/cards.h"
#include "tests/drivers/door/osdp/osdp_line.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/support/scratch.h"

static const uint8_t default_key[16] = "0123456789:;<=>?";
static const uint8_t key[16] = {2, 7, 1, 8, 2, 8, 1, 8, 2, 8, 4, 5, 9, 0, 4, 5};

struct door {
    struct rig *rig;
    struct osdp_line line;
    struct iso_panel *panel;
    struct iso_cards *cards;
};

static void open_door(struct door *door, struct rig *rig)
{
    struct iso_fault fault = {.text = ""};
    memset(door, 0, sizeof *door);
    door->rig = rig;
    osdp_line_open(&door->line, 0);
    const char *cards = scratch_path(rig->directory, "cards");
    scratch_write_text(cards, "17 4711 anna\n");
    assert_int_equal(iso_cards_load(cards, &door->cards, &fault), 0);
    const struct iso_panel_options options = {
        .port = door->line.path,
        .address = 5,
        .baud = 9600,
        .card_bits = 26,
        .path = scratch_path(rig->directory, "panel"),
        .ring = rig->borrowed.ring,
        .clock = iso_times_system().monotonic,
    };
    assert_int_equal(iso_panel_open(&options, &door->panel, &fault), 0);
    rig->borrowed.cards = door->cards;
    rig->borrowed.panel = door->panel;
    iso_appliance_free(rig->appliance);
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    rig_enrol(rig, "anna", 50);
    rig_enrol(rig, "boris", 70);
    rig_start(rig);
}

static void close_door(struct door *door)
{
    iso_appliance_free(door->rig->appliance);
    door->rig->appliance = NULL;
    door->rig->borrowed.panel = NULL;
    door->rig->borrowed.cards = NULL;
    iso_panel_close(door->panel);
    iso_cards_free(door->cards);
    osdp_line_close(&door->line);
}

static void come(struct rig *rig, int face, int frames)
{
    rig_show(rig, face, frames);
    rig_run(rig, 100);
}

/* The panel sets its key, as after `isotherm panel install`, and opens the channel. */
static void connect_panel(struct door *door)
{
    struct panel_reply reply;
    uint8_t keyset[18] = {1, 16};
    memcpy(keyset + 2, key, 16);
    assert_int_equal(iso_appliance_install_panel(door->rig->appliance, NULL), 0);
    assert_true(osdp_line_secure(&door->line, default_key));
    assert_int_equal(osdp_line_ask(&door->line, 0x75, keyset, 18, &reply), 0x40);
    assert_true(osdp_line_secure(&door->line, key));
}

/* Polls until the device has something to tell, or nothing, other than the state of its reader,
 * which is that of the puppets' sensor. */
static int poll_panel(struct door *door, struct panel_reply *reply)
{
    int code;
    do {
        code = osdp_line_ask(&door->line, 0x60, NULL, 0, reply);
    } while (code == 0x4B);
    return code;
}

static void assert_has(const char *record, const char *piece)
{
    if (!strstr(record, piece)) {
        fail_msg("%s has no %s", record, piece);
    }
}

static void test_admitted_person_has_a_card(void **state)
{
    struct door door;
    struct panel_reply reply;
    open_door(&door, *state);
    connect_panel(&door);
    come(door.rig, 50, 2);
    assert_has(rig_record(door.rig, "visit"), "\"person\":\"anna\"");
    assert_true(rig_relay(door.rig));
    assert_int_equal(poll_panel(&door, &reply), 0x50);
    assert_int_equal(reply.n, 8);
    assert_memory_equal(reply.data + 4, "\x88\x89\x33\xC0", 4);
    assert_int_equal(poll_panel(&door, &reply), 0x40);
    close_door(&door);
}

static void test_others_have_none(void **state)
{
    struct door door;
    struct panel_reply reply;
    open_door(&door, *state);
    connect_panel(&door);
    come(door.rig, 90, 6); /* a stranger */
    assert_int_equal(poll_panel(&door, &reply), 0x40);
    rig_run(door.rig, 60000);
    come(door.rig, 70, 2); /* nobody has entered a card for him */
    assert_has(rig_record(door.rig, "visit"), "\"person\":\"boris\"");
    assert_string_equal(door.rig->warned, "the admitted person has no card number");
    assert_int_equal(poll_panel(&door, &reply), 0x40);
    close_door(&door);
}

static bool is_lit(const struct door *door, enum iso_door_output output)
{
    bool active = false;
    assert_int_equal(iso_door_null_get_output(door->rig->door_io, output, &active), 0);
    return active;
}

/* The command LED: this colour, without end. */
static void show_lamp(struct door *door, uint8_t color)
{
    struct panel_reply reply;
    const uint8_t led[14] = {[9] = 1, [10] = 1, [12] = color, [13] = color};
    assert_int_equal(osdp_line_ask(&door->line, 0x69, led, sizeof led, &reply), 0x40);
    rig_run(door->rig, 300);
}

/* The lamp of the panel is shown by the lights of the door, as long as the door has nothing to
 * show itself; it never moves the relay. */
static void test_lamp_reaches_the_lights(void **state)
{
    struct door door;
    open_door(&door, *state);
    connect_panel(&door);
    show_lamp(&door, 1);
    assert_true(is_lit(&door, ISO_DOOR_LED_REFUSED));
    assert_false(is_lit(&door, ISO_DOOR_LED_GRANTED));
    show_lamp(&door, 3);
    assert_true(is_lit(&door, ISO_DOOR_LED_REFUSED) && is_lit(&door, ISO_DOOR_LED_GRANTED));
    assert_false(rig_relay(door.rig));
    show_lamp(&door, 1);
    come(door.rig, 50, 2); /* anna is let in: green, and no red */
    assert_true(rig_relay(door.rig));
    assert_true(is_lit(&door, ISO_DOOR_LED_GRANTED));
    assert_false(is_lit(&door, ISO_DOOR_LED_REFUSED));
    rig_run(door.rig, 10000);
    assert_true(is_lit(&door, ISO_DOOR_LED_REFUSED));
    show_lamp(&door, 0);
    assert_false(is_lit(&door, ISO_DOOR_LED_REFUSED));
    close_door(&door);
}

static void test_absent_panel_does_not_lock_the_door(void **state)
{
    struct door door;
    open_door(&door, *state);
    come(door.rig, 50, 2);
    assert_true(rig_relay(door.rig));
    assert_has(rig_record(door.rig, "visit"), "\"door\":\"unlocked\"");
    assert_string_equal(door.rig->warned,
                        "panel: the card was not sent: the panel is not connected");
    close_door(&door);
}

static void test_changes_are_on_record(void **state)
{
    struct door door;
    open_door(&door, *state);
    assert_string_equal(rig_record(door.rig, "panel"), "");
    assert_int_equal(iso_appliance_install_panel(door.rig->appliance, NULL), 0);
    assert_has(rig_record(door.rig, "panel"), "\"reason\":\"install\"");
    connect_panel(&door);
    rig_run(door.rig, 100);
    assert_has(rig_record(door.rig, "panel"), "\"reason\":\"secure\"");
    osdp_line_close(&door.line);
    struct iso_panel_look look;
    do {
        rig_run(door.rig, 100);
        iso_panel_look(door.panel, &look);
    } while (strcmp(look.state, "gone") != 0);
    rig_run(door.rig, 100);
    assert_has(rig_record(door.rig, "panel"), "\"reason\":\"line-gone\"");
    assert_string_equal(door.rig->warned, "panel line-gone");
    osdp_line_open(&door.line, 0);
    close_door(&door);
}

static void test_panel_knows_door_and_reader(void **state)
{
    struct door door;
    struct panel_reply reply;
    open_door(&door, *state);
    connect_panel(&door);
    come(door.rig, 50, 2);
    assert_int_equal(poll_panel(&door, &reply), 0x50);
    /* The person goes in, and the door shuts. */
    assert_int_equal(iso_door_null_set_input(door.rig->door_io, ISO_DOOR_CONTACT, true), 0);
    rig_run(door.rig, 200);
    assert_int_equal(poll_panel(&door, &reply), 0x49);
    assert_int_equal(reply.n, 1);
    assert_int_equal(reply.data[0], 1);
    assert_int_equal(iso_door_null_set_input(door.rig->door_io, ISO_DOOR_CONTACT, false), 0);
    rig_run(door.rig, 200);
    assert_int_equal(poll_panel(&door, &reply), 0x49);
    assert_int_equal(reply.data[0], 0);
    /* Somebody opens the housing. */
    assert_int_equal(iso_door_null_set_input(door.rig->door_io, ISO_DOOR_TAMPER, true), 0);
    rig_run(door.rig, 200);
    assert_int_equal(poll_panel(&door, &reply), 0x48);
    assert_int_equal(reply.data[0], 1);
    /* The sensor is unplugged, and works again later. */
    door.rig->sensor.wait_error = door.rig->sensor.open_error = -ENODEV;
    rig_run(door.rig, 1000);
    assert_int_equal(osdp_line_ask(&door.line, 0x67, NULL, 0, &reply), 0x4B);
    assert_int_equal(reply.data[0], 1);
    door.rig->sensor.wait_error = door.rig->sensor.open_error = 0;
    rig_run(door.rig, 60000);
    rig_show_unusable(door.rig, ISO_CAPTURE_NOBODY, 2);
    rig_run(door.rig, 1000);
    assert_int_equal(osdp_line_ask(&door.line, 0x67, NULL, 0, &reply), 0x4B);
    assert_int_equal(reply.data[0], 0);
    close_door(&door);
}

static void test_without_a_panel(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault;
    rig_start(rig);
    assert_int_equal(iso_appliance_panel_fd(rig->appliance), -1);
    assert_int_equal(iso_appliance_install_panel(rig->appliance, &fault), -ENODEV);
    assert_string_equal(fault.text, "there is no access panel: [panel] port is empty");
    assert_string_equal(rig_record(rig, "panel"), "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_admitted_person_has_a_card, rig_setup, rig_teardown),
        cmocka_unit_test_setup_teardown(test_others_have_none, rig_setup, rig_teardown),
        cmocka_unit_test_setup_teardown(test_lamp_reaches_the_lights, rig_setup, rig_teardown),
        cmocka_unit_test_setup_teardown(test_absent_panel_does_not_lock_the_door, rig_setup,
                                        rig_teardown),
        cmocka_unit_test_setup_teardown(test_changes_are_on_record, rig_setup, rig_teardown),
        cmocka_unit_test_setup_teardown(test_panel_knows_door_and_reader, rig_setup, rig_teardown),
        cmocka_unit_test_setup_teardown(test_without_a_panel, rig_setup, rig_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
