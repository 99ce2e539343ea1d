/* The service on a private bus: the methods that list people and change them. */
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/contract.h"
#include "tests/firmware/rigs/bus_rig.h"

/* Returns the fields of EnrollStart's answer about a name, "" if nobody has it. */
static const char *known_of(struct bus_rig *f, const char *person)
{
    static char text[256];
    const char *key, *name = "";
    sd_bus_message *message = bus_rig_new_call(f, 0, ISO_CONTRACT_ENROLL_START);
    assert_true(sd_bus_message_append(message, "sa{sv}", person, 0) >= 0);
    struct bus_answer *answer = bus_rig_send(f, 0, message);
    assert_string_equal(answer->error, "");
    assert_true(sd_bus_message_has_signature(answer->reply, "a{sv}"));
    text[0] = '\0';
    int64_t times[3] = {0};
    uint32_t templates = 0;
    assert_true(sd_bus_message_enter_container(answer->reply, 'a', "{sv}") > 0);
    while (sd_bus_message_enter_container(answer->reply, 'e', "sv") > 0) {
        assert_true(sd_bus_message_read(answer->reply, "s", &key) > 0);
        int r = 0;
        if (strcmp(key, "person") == 0) {
            r = sd_bus_message_read(answer->reply, "v", "s", &name);
        } else if (strcmp(key, "templates") == 0) {
            r = sd_bus_message_read(answer->reply, "v", "u", &templates);
        }
        static const char *const time_names[] = {"enrolled", "valid-from", "valid-until"};
        for (size_t i = 0; i < 3 && r == 0; i++) {
            if (strcmp(key, time_names[i]) == 0) {
                r = sd_bus_message_read(answer->reply, "v", "x", &times[i]);
            }
        }
        assert_true(r > 0);
        assert_true(sd_bus_message_exit_container(answer->reply) > 0);
        (void)snprintf(text, sizeof text, "%s %lld %lld %lld %u", name, (long long)times[0],
                       (long long)times[1], (long long)times[2], templates);
    }
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_ENROLL_STOP, NULL), "");
    return text;
}

static void reports_who_has_a_name(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    const struct iso_validity limits = {5, 1800000000};
    rig_enrol(f->rig, "Anna", 50);
    rig_enrol(f->rig, "Anna", 51);
    assert_int_equal(iso_gallery_set_validity(f->rig->gallery, "Anna", &limits, NULL), 0);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(known_of(f, "zoe"), "");
    assert_string_equal(known_of(f, "ANNA"), "Anna 1 5 1800000000 2");
}

static int read_duplicate(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    const char *result, *person;
    (void)error;
    assert_true(sd_bus_message_has_signature(signal, "sbuuds"));
    assert_true(sd_bus_message_read(signal, "s", &result) > 0);
    assert_true(sd_bus_message_skip(signal, "buud") > 0);
    assert_true(sd_bus_message_read(signal, "s", &person) > 0);
    (void)snprintf(context, 64, "%s '%s'", result, person);
    return 0;
}

static void names_the_person_of_a_duplicate(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    char told[64] = "", others[64] = "";
    for (int i = 0; i < 2; i++) {
        assert_true(sd_bus_match_signal(f->client[i], NULL, ISO_CONTRACT_NAME, ISO_CONTRACT_PATH,
                                        ISO_CONTRACT_INTERFACE, ISO_CONTRACT_ENROLL_STATUS,
                                        read_duplicate, i ? others : told) >= 0);
    }
    rig_enrol(f->rig, "anna", 50);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    sd_bus_message *message = bus_rig_new_call(f, 0, ISO_CONTRACT_ENROLL_START);
    assert_true(sd_bus_message_append(message, "sa{sv}", "bob", 0) >= 0);
    assert_string_equal(bus_rig_send(f, 0, message)->error, "");
    rig_show(f->rig, 50, 2);
    bus_rig_run(f, 100);
    assert_string_equal(told, "enroll-stage-passed ''");
    rig_show(f->rig, 50, 1);
    bus_rig_run(f, 100);
    assert_string_equal(told, "enroll-duplicate 'anna'");
    assert_string_equal(others, ""); /* the other client gets no signal */
}

/* Calls SetValidity with one option. Returns the answer, or its error. */
static const char *set_validity(struct bus_rig *f, const char *person, const char *option,
                                int64_t value, bool expired)
{
    static char text[128];
    const char *name;
    int64_t from, until;
    sd_bus_message *message = bus_rig_new_call(f, 1, ISO_CONTRACT_SET_VALIDITY);
    assert_true(sd_bus_message_append(message, "s", person) >= 0);
    assert_true((option ? sd_bus_message_append(message, "a{sv}", 2, option, "x", value,
                                                ISO_CONTRACT_EXPIRED, "b", (int)expired)
                        : sd_bus_message_append(message, "a{sv}", 0)) >= 0);
    struct bus_answer *answer = bus_rig_send(f, 1, message);
    if (answer->error[0]) {
        return strrchr(answer->error, '.') + 1;
    }
    assert_true(sd_bus_message_read(answer->reply, "sxx", &name, &from, &until) > 0);
    (void)snprintf(text, sizeof text, "%s %lld %lld", name, (long long)from, (long long)until);
    return text;
}

static void changes_limits(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    rig_enrol(f->rig, "Anna", 50);
    assert_string_equal(set_validity(f, "anna", ISO_CONTRACT_VALID_FROM, 1795000000, false),
                        "Anna 1795000000 0");
    assert_string_equal(set_validity(f, "anna", ISO_CONTRACT_VALID_UNTIL, 1798675199, false),
                        "Anna 1795000000 1798675199");
    assert_string_equal(set_validity(f, "anna", ISO_CONTRACT_VALID_FROM, 0, false),
                        "Anna 0 1798675199");
    assert_string_equal(set_validity(f, "anna", ISO_CONTRACT_VALID_UNTIL, 1795000001, false),
                        "InvalidArgument");
    assert_string_equal(set_validity(f, "anna", ISO_CONTRACT_VALID_UNTIL, 1795000001, true),
                        "Anna 0 1795000001");
    assert_string_equal(set_validity(f, "anna", ISO_CONTRACT_ALLOW_DUPLICATE, 1, true),
                        "InvalidArgument"); /* not one of its options */
    assert_string_equal(set_validity(f, "anna", NULL, 0, false), "InvalidArgument");
    assert_string_equal(set_validity(f, "zac", ISO_CONTRACT_VALID_FROM, 5, false), "NoSuchPerson");
}

static const char *rename_person(struct bus_rig *f, const char *person, const char *name)
{
    sd_bus_message *message = bus_rig_new_call(f, 1, ISO_CONTRACT_RENAME_PERSON);
    assert_true(sd_bus_message_append(message, "ss", person, name) >= 0);
    const struct bus_answer *answer = bus_rig_send(f, 1, message);
    const char *dot = strrchr(answer->error, '.');
    return dot ? dot + 1 : answer->error;
}

static void renames(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    rig_enrol(f->rig, "ada", 50);
    rig_enrol(f->rig, "bob", 70);
    assert_string_equal(rename_person(f, "ada", "Bob"), "NameInUse");
    assert_string_equal(rename_person(f, "zac", "eve"), "NoSuchPerson");
    assert_string_equal(rename_person(f, "ada", "e\tve"), "InvalidName");
    assert_string_equal(rename_person(f, "ada", "Ada Lovelace"), "");
    assert_non_null(iso_gallery_find(f->rig->gallery, "Ada Lovelace"));
    assert_null(iso_gallery_find(f->rig->gallery, "ada"));
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, bus_rig_setup, bus_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(reports_who_has_a_name),
        TEST(names_the_person_of_a_duplicate),
        TEST(changes_limits),
        TEST(renames),
    };
    return cmocka_run_group_tests(tests, bus_rig_group_setup, bus_rig_group_teardown);
}
