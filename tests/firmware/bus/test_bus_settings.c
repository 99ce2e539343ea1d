/* The method GetSettings: the configuration that is in force, as an administrator sees it. */
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/config/settings.h"
#include "firmware/contract/contract.h"
#include "tests/firmware/rigs/bus_rig.h"

static sd_bus_message *ask(struct bus_rig *f)
{
    struct bus_answer *answer = bus_rig_send(f, 0,
                                             bus_rig_new_call(f, 0, ISO_CONTRACT_GET_SETTINGS));
    assert_string_equal(answer->error, "");
    assert_true(sd_bus_message_enter_container(answer->reply, 'a', "(ssssss)") > 0);
    return answer->reply;
}

/* Reads the value of a key. The test fails if there is no such key. */
static const char *find_value(struct bus_rig *f, const char *section, const char *key)
{
    const char *at, *name, *value, *standard, *range, *help;
    sd_bus_message *reply = ask(f);
    while (sd_bus_message_read(reply, "(ssssss)", &at, &name, &value, &standard, &range, &help) >
           0) {
        if (strcmp(at, section) == 0 && strcmp(name, key) == 0) {
            return value;
        }
    }
    fail_msg("there is no [%s] %s", section, key);
    return NULL;
}

/* Compares one setting of the configuration with the next one of the reply. */
static int expect_next(void *context, const struct iso_setting *want)
{
    const char *section, *key, *value, *standard, *range, *help;
    assert_true(sd_bus_message_read(context, "(ssssss)", &section, &key, &value, &standard, &range,
                                    &help) > 0);
    assert_string_equal(section, want->section);
    assert_string_equal(key, want->key);
    assert_string_equal(value, want->value);
    assert_string_equal(standard, want->standard);
    assert_string_equal(range, want->range);
    assert_string_equal(help, want->help);
    return 0;
}

static void the_reply_is_the_whole_configuration_in_its_order(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    sd_bus_message *reply = ask(f);
    assert_int_equal(iso_config_visit_settings(&f->rig->config, expect_next, reply), 0);
    assert_int_equal(sd_bus_message_at_end(reply, 0), 1);
}

static void values_are_those_in_force(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    assert_string_equal(find_value(f, "decision", "threshold"), "6");
    assert_string_equal(find_value(f, "door", "backend"), "null");
    assert_string_equal(find_value(f, "door", "inputs"), "");
    f->rig->config.decision.level = ISO_LEVEL_STRICT;
    assert_string_equal(find_value(f, "decision", "level"), "strict");
}

static void a_name_of_a_file_that_is_not_utf_8_is_shown_all_the_same(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    (void)snprintf(f->rig->config.door.cards, sizeof f->rig->config.door.cards,
                   "/etc/\xff"
                   "cards");
    assert_string_equal(find_value(f, "door", "cards"), "/etc/?cards");
    char longest[ISO_CONFIG_TEXT_SIZE];
    memset(longest, 'x', sizeof longest - 1);
    longest[sizeof longest - 1] = '\0';
    (void)snprintf(f->rig->config.door.cards, sizeof longest, "%s", longest);
    assert_string_equal(find_value(f, "door", "cards"), longest);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, bus_rig_setup, bus_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(the_reply_is_the_whole_configuration_in_its_order),
        TEST(values_are_those_in_force),
        TEST(a_name_of_a_file_that_is_not_utf_8_is_shown_all_the_same),
    };
    return cmocka_run_group_tests(tests, bus_rig_group_setup, bus_rig_group_teardown);
}
