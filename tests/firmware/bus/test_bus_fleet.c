/* The service on a private bus: the methods of isotherm-link. */
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/appliance/administration/administration.h"
#include "firmware/contract/contract.h"
#include "tests/firmware/fleet/door/door_rig.h"
#include "tests/firmware/rigs/bus_rig.h"

static struct door_rig hub;

static const char *error_of(const struct bus_answer *answer)
{
    const char *dot = strrchr(answer->error, '.');
    return dot ? dot + 1 : answer->error;
}

static struct bus_answer *send_bytes(struct bus_rig *f, const char *method,
                                     struct iso_fleet_bytes bytes)
{
    sd_bus_message *message = bus_rig_new_call(f, 1, method);
    assert_true(sd_bus_message_append_array(message, 'y', bytes.bytes, bytes.size) >= 0);
    iso_fleet_bytes_free(&bytes);
    return bus_rig_send(f, 1, message);
}

static void expect_outcome(struct bus_rig *f, struct iso_fleet_bytes message, const char *word,
                           bool names_zone)
{
    const char *outcome, *zone;
    char text[ISO_FLEET_ID_TEXT_SIZE];
    struct bus_answer *answer = send_bytes(f, ISO_CONTRACT_FLEET_RECEIVE, message);
    assert_string_equal(answer->error, "");
    assert_true(sd_bus_message_read(answer->reply, "ss", &outcome, &zone) > 0);
    assert_string_equal(outcome, word);
    assert_string_equal(zone, names_zone ? iso_fleet_id_text(&hub.zone[0].place.zone, text) : "");
}

/* Calls a method whose reply begins with bytes; they are valid until the next call. */
static const void *ask_bytes(struct bus_rig *f, sd_bus_message *call, size_t *size)
{
    const void *bytes = NULL;
    struct bus_answer *answer = bus_rig_send(f, 1, call);
    assert_string_equal(answer->error, "");
    assert_true(sd_bus_message_read_array(answer->reply, 'y', &bytes, size) > 0);
    return bytes;
}

/* The text value of a key of GetFleet, "-": it is not there. */
static const char *fleet_text(struct bus_rig *f, const char *wanted)
{
    static char text[128];
    const char *key, *value;
    struct bus_answer *answer = bus_rig_send(f, 1, bus_rig_new_call(f, 1, ISO_CONTRACT_GET_FLEET));
    (void)snprintf(text, sizeof text, "-");
    assert_string_equal(answer->error, "");
    assert_true(sd_bus_message_enter_container(answer->reply, 'a', "{sv}") > 0);
    while (sd_bus_message_enter_container(answer->reply, 'e', "sv") > 0) {
        assert_true(sd_bus_message_read(answer->reply, "s", &key) > 0);
        if (strcmp(key, wanted) == 0) {
            assert_true(sd_bus_message_read(answer->reply, "v", "s", &value) > 0);
            (void)snprintf(text, sizeof text, "%s", value);
        } else {
            assert_true(sd_bus_message_skip(answer->reply, "v") >= 0);
        }
        assert_true(sd_bus_message_exit_container(answer->reply) >= 0);
    }
    return text;
}

static void make_hub(struct bus_rig *f)
{
    struct iso_transfer_keys keys;
    hub = (struct door_rig){.directory = f->rig->directory, .gallery = f->rig->gallery};
    iso_transfer_get_keys(f->rig->borrowed.ring, &keys);
    memcpy(hub.door_signs.public, keys.signs, sizeof keys.signs);
    memcpy(hub.door_receives.public, keys.receives, sizeof keys.receives);
    hub.fleet = iso_appliance_fleet(f->rig->appliance);
    door_rig_make_hub(&hub);
}

static void join(struct bus_rig *f)
{
    make_hub(f);
    assert_string_equal(send_bytes(f, ISO_CONTRACT_FLEET_JOIN, door_rig_membership(&hub))->error,
                        "");
}

static void a_door_without_a_fleet_says_so(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    assert_string_equal(fleet_text(f, ISO_CONTRACT_FLEET_DOOR), "-");
    static const char *const methods[] = {ISO_CONTRACT_FLEET_LEAVE, ISO_CONTRACT_FLEET_QUESTION,
                                          ISO_CONTRACT_FLEET_REQUESTS};
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        struct bus_answer *answer = bus_rig_send(f, 1, bus_rig_new_call(f, 1, methods[i]));
        assert_string_equal(error_of(answer), "NoFleet");
    }
    const struct iso_fleet_bytes nothing = {.bytes = NULL};
    assert_string_equal(error_of(send_bytes(f, ISO_CONTRACT_FLEET_RECEIVE, nothing)), "NoFleet");
    assert_string_equal(error_of(send_bytes(f, ISO_CONTRACT_FLEET_JOIN, nothing)), "Rejected");
}

static void a_door_joins_and_leaves(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    char text[ISO_FLEET_ID_TEXT_SIZE];
    join(f);
    assert_string_equal(fleet_text(f, ISO_CONTRACT_FLEET_DOOR), iso_fleet_id_text(&hub.door, text));
    assert_string_equal(fleet_text(f, ISO_CONTRACT_FLEET_HUB_NAME), "HQ");
    assert_string_equal(fleet_text(f, ISO_CONTRACT_FLEET_LEASE), "none");
    assert_non_null(strstr(rig_record(f->rig, "fleet"), "asked by user"));
    make_hub(f); /* another one */
    assert_string_equal(error_of(send_bytes(f, ISO_CONTRACT_FLEET_JOIN, door_rig_membership(&hub))),
                        "Conflict");
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_FLEET_LEAVE, NULL), "");
    assert_string_equal(fleet_text(f, ISO_CONTRACT_FLEET_DOOR), "-");
}

static void messages_come_over_the_bus(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct iso_fleet_bytes copy = {.bytes = NULL};
    join(f);
    expect_outcome(f, door_rig_lease(&hub, 1), "applied", false);
    assert_string_equal(fleet_text(f, ISO_CONTRACT_FLEET_LEASE), "held");
    expect_outcome(f, door_rig_key(&hub, 0), "applied", true);
    struct iso_fleet_bytes delta = door_rig_put(&hub, 0, 1, 1, "ada", 60, false);
    iso_fleet_put(&copy, delta.bytes, delta.size);
    expect_outcome(f, delta, "applied", true);
    expect_outcome(f, copy, "known", true);
    expect_outcome(f, (struct iso_fleet_bytes){.bytes = NULL}, "refused", false);
    assert_non_null(iso_gallery_find(f->rig->gallery, "ada"));
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_DELETE_PERSON, "ada"), "InvalidArgument");
}

static void a_snapshot_comes_as_a_file(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    const char *outcome, *zone;
    FILE *file = tmpfile();
    join(f);
    hub.zone[0].place.sequence = 9;
    expect_outcome(f, door_rig_lease(&hub, 1), "applied", false);
    expect_outcome(f, door_rig_key(&hub, 0), "whole", true);
    struct iso_fleet_bytes change = door_rig_change(1, 1, "ada", 60);
    struct iso_fleet_bytes bytes = door_rig_snapshot(&hub, 0, &change, 1);
    assert_int_equal(fwrite(bytes.bytes, 1, bytes.size, file), bytes.size);
    assert_int_equal(fflush(file), 0);
    iso_fleet_bytes_free(&bytes);
    sd_bus_message *call = bus_rig_new_call(f, 1, ISO_CONTRACT_FLEET_SNAPSHOT);
    assert_true(sd_bus_message_append(call, "h", fileno(file)) >= 0);
    struct bus_answer *answer = bus_rig_send(f, 1, call);
    assert_string_equal(answer->error, "");
    assert_true(sd_bus_message_read(answer->reply, "ss", &outcome, &zone) > 0);
    assert_string_equal(outcome, "applied");
    assert_non_null(iso_gallery_find(f->rig->gallery, "ada"));
    (void)fclose(file);
}

static void the_door_asks_over_the_bus(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct iso_fleet_question question;
    struct iso_fleet_fetch fetch;
    char text[ISO_FLEET_ID_TEXT_SIZE];
    size_t size = 0;
    join(f);
    expect_outcome(f, door_rig_lease(&hub, 1), "applied", false);
    const void *bytes = ask_bytes(f, bus_rig_new_call(f, 1, ISO_CONTRACT_FLEET_QUESTION), &size);
    assert_int_equal(iso_fleet_read_question(bytes, size, hub.door_signs.public, &question), 0);
    assert_int_equal(question.n, 1);
    assert_non_null(memmem(question.health, question.health_length, "\"sensor-state\":", 15));
    sd_bus_message *call = bus_rig_new_call(f, 1, ISO_CONTRACT_FLEET_FETCH);
    assert_true(sd_bus_message_append(call, "ss", iso_fleet_id_text(&hub.zone[0].place.zone, text),
                                      ISO_CONTRACT_FLEET_SNAPSHOT_WORD) >= 0);
    bytes = ask_bytes(f, call, &size);
    assert_int_equal(iso_fleet_read_fetch(bytes, size, hub.door_signs.public, &fetch), 0);
    assert_int_equal(fetch.what, ISO_FLEET_WANT_SNAPSHOT);
    static const char *const wrong[][2] = {{"zone", "deltas"}, {NULL, "all"}};
    for (int i = 0; i < 2; i++) {
        call = bus_rig_new_call(f, 1, ISO_CONTRACT_FLEET_FETCH);
        assert_true(
            sd_bus_message_append(call, "ss", wrong[i][0] ? wrong[i][0] : text, wrong[i][1]) >= 0);
        assert_string_equal(error_of(bus_rig_send(f, 1, call)), "InvalidArgument");
    }
}

static void send_update(struct bus_rig *f, const char *state, const char *version,
                        const char *fault, const char *error)
{
    static const char rollout[] = "01234567-89ab-cdef-0123-456789abcdef";
    int busy = -1;
    sd_bus_message *call = bus_rig_new_call(f, 1, ISO_CONTRACT_FLEET_UPDATE);
    assert_true(sd_bus_message_append(call, "sssss", state, rollout, version, "board", fault) >= 0);
    struct bus_answer *answer = bus_rig_send(f, 1, call);
    assert_string_equal(error_of(answer), error);
    if (!*error) {
        assert_true(sd_bus_message_read(answer->reply, "b", &busy) > 0);
        assert_int_equal(busy, 0);
    }
}

static void the_state_of_an_update_goes_into_the_question(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct iso_fleet_question question;
    struct iso_fleet_fetch fetch;
    size_t size = 0;
    join(f);
    const void *bytes = ask_bytes(f, bus_rig_new_call(f, 1, ISO_CONTRACT_FLEET_QUESTION), &size);
    assert_int_equal(iso_fleet_read_question(bytes, size, hub.door_signs.public, &question), 0);
    assert_null(memmem(question.health, question.health_length, "update-state", 12));
    send_update(f, "fetching", "1.2", "no line", "");
    bytes = ask_bytes(f, bus_rig_new_call(f, 1, ISO_CONTRACT_FLEET_QUESTION), &size);
    assert_int_equal(iso_fleet_read_question(bytes, size, hub.door_signs.public, &question), 0);
    static const char expected[] =
        "\"update-state\":\"fetching\",\"update-rollout\":\"01234567-89ab-cdef-0123-456789abcdef\","
        "\"image-version\":\"1.2\",\"image-board\":\"board\",\"update-fault\":\"no line\"";
    assert_non_null(memmem(question.health, question.health_length, expected, sizeof expected - 1));
    send_update(f, "sleeping", "1.2", "", "InvalidArgument");
    send_update(f, "idle", "1 2", "", "InvalidArgument");
    send_update(f, "idle", "1.2", "two\nlines", "InvalidArgument");
    sd_bus_message *call = bus_rig_new_call(f, 1, ISO_CONTRACT_FLEET_FETCH_UPDATE);
    assert_true(sd_bus_message_append(call, "st", "01234567-89ab-cdef-0123-456789abcdef",
                                      UINT64_C(4096)) >= 0);
    bytes = ask_bytes(f, call, &size);
    assert_int_equal(iso_fleet_read_fetch(bytes, size, hub.door_signs.public, &fetch), 0);
    assert_int_equal(fetch.what, ISO_FLEET_WANT_UPDATE);
    assert_int_equal(fetch.after, 4096);
    assert_int_equal(fetch.zone.bytes[1], 0x23);
    call = bus_rig_new_call(f, 1, ISO_CONTRACT_FLEET_FETCH_UPDATE);
    assert_true(sd_bus_message_append(call, "st", "rollout", UINT64_C(0)) >= 0);
    assert_string_equal(error_of(bus_rig_send(f, 1, call)), "InvalidArgument");
}

static void events_and_requests_go_over_the_bus(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    uint64_t last = 0;
    size_t size = 0;
    join(f);
    rig_enrol(f->rig, "visitor", 60);
    sd_bus_message *call = bus_rig_new_call(f, 1, ISO_CONTRACT_FLEET_EVENTS);
    assert_true(sd_bus_message_append(call, "tu", UINT64_C(0), 3u) >= 0);
    struct bus_answer *answer = bus_rig_send(f, 1, call);
    const void *bytes = NULL;
    assert_true(sd_bus_message_read_array(answer->reply, 'y', &bytes, &size) > 0);
    assert_true(sd_bus_message_read(answer->reply, "t", &last) > 0);
    assert_int_equal(last, 3);
    struct iso_fleet_events events;
    struct iso_fleet_bytes lines = {.bytes = NULL};
    assert_int_equal(iso_fleet_read_events(bytes, size, hub.door_signs.public, &hub.hub_receives,
                                           &events, &lines),
                     0);
    assert_int_equal(events.first, 1);
    assert_non_null(memmem(lines.bytes, lines.size, "\"event\":\"start\"", 15));
    iso_fleet_bytes_free(&lines);
    answer = bus_rig_send(f, 1, bus_rig_new_call(f, 1, ISO_CONTRACT_FLEET_REQUESTS));
    assert_true(sd_bus_message_has_signature(answer->reply, "aay"));
    assert_true(sd_bus_message_enter_container(answer->reply, 'a', "ay") > 0);
    assert_true(sd_bus_message_read_array(answer->reply, 'y', &bytes, &size) > 0);
    assert_int_equal(sd_bus_message_read_array(answer->reply, 'y', &bytes, &size), 0);
}

static void the_link_is_told_what_waits(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    join(f);
    expect_outcome(f, door_rig_lease(&hub, 1), "applied", false);
    (void)bus_rig_news(f, 1);
    bus_rig_run(f, 1500);
    const char *news = bus_rig_news(f, 1);
    assert_non_null(strstr(news, "FleetWork places"));
    assert_non_null(strstr(news, "FleetWork events"));
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, bus_rig_setup, bus_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_door_without_a_fleet_says_so),
        TEST(a_door_joins_and_leaves),
        TEST(messages_come_over_the_bus),
        TEST(a_snapshot_comes_as_a_file),
        TEST(the_door_asks_over_the_bus),
        TEST(events_and_requests_go_over_the_bus),
        TEST(the_state_of_an_update_goes_into_the_question),
        TEST(the_link_is_told_what_waits),
    };
    return cmocka_run_group_tests(tests, bus_rig_group_setup, bus_rig_group_teardown);
}
