/* The methods GetSettings, SetSetting and ResetSetting: the configuration that is in force, as an
 * administrator sees and changes it. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/config/settings.h"
#include "firmware/contract/contract.h"
#include "firmware/settings/live_keys.h"
#include "tests/firmware/rigs/bus_rig.h"

static sd_bus_message *ask(struct bus_rig *f)
{
    struct bus_answer *answer = bus_rig_send(f, 0,
                                             bus_rig_new_call(f, 0, ISO_CONTRACT_GET_SETTINGS));
    assert_string_equal(answer->error, "");
    assert_true(sd_bus_message_enter_container(answer->reply, 'a', "(ssssssbs)") > 0);
    return answer->reply;
}

/* Reads the value of a key. The test fails if there is no such key. */
static const char *find_value(struct bus_rig *f, const char *section, const char *key)
{
    const char *at, *name, *value, *standard, *range, *help, *configured;
    int changeable;
    sd_bus_message *reply = ask(f);
    while (sd_bus_message_read(reply, "(ssssssbs)", &at, &name, &value, &standard, &range, &help,
                               &changeable, &configured) > 0) {
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
    const char *section, *key, *value, *standard, *range, *help, *configured;
    int changeable;
    assert_true(sd_bus_message_read(context, "(ssssssbs)", &section, &key, &value, &standard,
                                    &range, &help, &changeable, &configured) > 0);
    assert_int_equal(changeable, iso_live_key_find(section, key) != NULL);
    assert_string_equal(configured, want->value);
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

/* Changes a setting (NULL: resets it). Returns "" or the last word of the error's name. */
static const char *change(struct bus_rig *f, const char *section, const char *key,
                          const char *value, const char *expected)
{
    const char *now;
    sd_bus_message *call = bus_rig_new_call(
        f, 0, value ? ISO_CONTRACT_SET_SETTING : ISO_CONTRACT_RESET_SETTING);
    assert_true(sd_bus_message_append(call, "ss", section, key) >= 0);
    if (value) {
        assert_true(sd_bus_message_append(call, "s", value) >= 0);
    }
    struct bus_answer *answer = bus_rig_send(f, 0, call);
    if (*answer->error) {
        assert_string_equal(answer->text, expected);
        return strrchr(answer->error, '.') + 1;
    }
    assert_true(sd_bus_message_read(answer->reply, "s", &now) > 0);
    assert_string_equal(now, expected);
    return "";
}

static void a_setting_is_changed_and_reset_on_record_with_the_user(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    char who[64];
    (void)snprintf(who, sizeof who, "asked by user %u", (unsigned)getuid());
    assert_string_equal(change(f, "door", "unlock_ms", "7000", "7000"), "");
    assert_string_equal(find_value(f, "door", "unlock_ms"), "7000");
    const char *line = rig_record(f->rig, "setting");
    assert_non_null(strstr(line, "\"reason\":\"set\""));
    assert_non_null(strstr(line, "\"before\":\"4000\",\"after\":\"7000\""));
    assert_non_null(strstr(line, "door.unlock_ms"));
    assert_non_null(strstr(line, who));
    assert_string_equal(change(f, "door", "unlock_ms", NULL, "4000"), "");
    assert_string_equal(find_value(f, "door", "unlock_ms"), "4000");
    assert_non_null(strstr(rig_record(f->rig, "setting"), "\"reason\":\"reset\""));
}

static void the_value_of_the_file_is_beside_the_value_in_force(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    const char *section, *key, *value, *standard, *range, *help, *configured;
    int changeable = 0, found = 0;
    assert_string_equal(change(f, "decision", "margin", "2.5", "2.5"), "");
    sd_bus_message *reply = ask(f);
    while (sd_bus_message_read(reply, "(ssssssbs)", &section, &key, &value, &standard, &range,
                               &help, &changeable, &configured) > 0) {
        if (strcmp(key, "margin") == 0) {
            assert_string_equal(value, "2.5");
            assert_string_equal(configured, "1");
            assert_string_equal(standard, "0");
            assert_true(changeable);
            found++;
        }
    }
    assert_int_equal(found, 1);
}

static void what_the_file_would_refuse_is_refused_with_the_same_words(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    static const struct {
        const char *section, *key, *value, *text;
    } cases[] = {
        {"door", "unlock_ms", "99",
         "bad value '99' for 'unlock_ms' (a whole number, 100 to 600000)"},
        {"door", "unlock_ms", "", "bad value '' for 'unlock_ms' (a whole number, 100 to 600000)"},
        {"decision", "level", "lax", "bad value 'lax' for 'level' (convenient|balanced|strict)"},
        {"decision", "agree", "7", "[decision] agree is above max_frames"},
        {"decision", "nothing", "1", "unknown key 'nothing' in [decision]"},
        {"door", "fail", "safe",
         "[door] fail cannot be changed while the daemon runs: change it in the configuration file "
         "and restart the daemon"},
        {"gallery", "path", "/tmp/x",
         "[gallery] path cannot be changed while the daemon runs: change it in the configuration "
         "file and restart the daemon"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_string_equal(
            change(f, cases[i].section, cases[i].key, cases[i].value, cases[i].text),
            "InvalidArgument");
    }
    assert_string_equal(rig_record(f->rig, "setting"), "");
    assert_string_equal(find_value(f, "door", "unlock_ms"), "4000");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, bus_rig_setup, bus_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(the_reply_is_the_whole_configuration_in_its_order),
        TEST(values_are_those_in_force),
        TEST(a_setting_is_changed_and_reset_on_record_with_the_user),
        TEST(the_value_of_the_file_is_beside_the_value_in_force),
        TEST(what_the_file_would_refuse_is_refused_with_the_same_words),
        TEST(a_name_of_a_file_that_is_not_utf_8_is_shown_all_the_same),
    };
    return cmocka_run_group_tests(tests, bus_rig_group_setup, bus_rig_group_teardown);
}
