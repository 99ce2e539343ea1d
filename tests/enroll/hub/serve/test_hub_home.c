/* What Home Assistant is told about a door. */
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/hub/serve/home_text.h"

static struct hub_door door_with(const char *health)
{
    struct hub_door door = {.joined_s = 1, .name = "Gate"};

    assert_int_equal(iso_fleet_id_read("0190b3f2-1111-4222-8333-444455556666", &door.id), 0);
    strcpy(door.health, health);
    return door;
}

static void a_door_is_announced_without_commands(void **state)
{
    const struct hub_door door = door_with("");
    char topic[HOME_TOPIC_SIZE];
    (void)state;

    assert_string_equal(
        home_topic_config(&door, HOME_LOCK, topic),
        "homeassistant/binary_sensor/isotherm-0190b3f2-1111-4222-8333-444455556666/lock/config");
    for (int part = 0; part < HOME_PARTS; part++) {
        char *text = home_config(&door, part, "Office");
        assert_non_null(text);
        json_t *json = json_loads(text, JSON_REJECT_DUPLICATES, NULL);
        assert_non_null(json);
        assert_null(strstr(text, "command"));
        assert_string_equal(json_string_value(json_object_get(json, "state_topic")),
                            "isotherm/door/0190b3f2-1111-4222-8333-444455556666/state");
        assert_string_equal(json_string_value(json_object_get(json, "availability_topic")),
                            "isotherm/door/0190b3f2-1111-4222-8333-444455556666/online");
        json_decref(json);
        free(text);
    }
}

static void the_state_follows_the_report(void **state)
{
    static const struct {
        const char *health;
        bool lockdown;
        const char *text;
    } cases[] = {
        {"", false, "{\"lock\":null,\"contact\":null,\"tamper\":null,\"lockdown\":\"OFF\"}"},
        {"broken", true, "{\"lock\":null,\"contact\":null,\"tamper\":null,\"lockdown\":\"ON\"}"},
        {"{\"door-state\":\"locked\"}", false,
         "{\"lock\":\"OFF\",\"contact\":\"OFF\",\"tamper\":\"OFF\",\"lockdown\":\"OFF\"}"},
        {"{\"door-state\":\"unlocked\"}", false,
         "{\"lock\":\"ON\",\"contact\":\"OFF\",\"tamper\":\"OFF\",\"lockdown\":\"OFF\"}"},
        {"{\"door-state\":\"held-open\",\"tamper\":1}", false,
         "{\"lock\":\"ON\",\"contact\":\"ON\",\"tamper\":\"ON\",\"lockdown\":\"OFF\"}"},
        {"{\"door-state\":\"forced\"}", false,
         "{\"lock\":\"ON\",\"contact\":\"ON\",\"tamper\":\"ON\",\"lockdown\":\"OFF\"}"},
        {"{\"door-state\":\"fault\",\"tamper\":0,\"name\":\"Anna\"}", false,
         "{\"lock\":null,\"contact\":null,\"tamper\":\"OFF\",\"lockdown\":\"OFF\"}"},
        {"{\"door-state\":7}", false,
         "{\"lock\":null,\"contact\":null,\"tamper\":null,\"lockdown\":\"OFF\"}"},
    };
    (void)state;

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct hub_door door = door_with(cases[i].health);
        char *text = home_state(&door, cases[i].lockdown);
        assert_string_equal(text, cases[i].text);
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_door_is_announced_without_commands),
        cmocka_unit_test(the_state_follows_the_report),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
