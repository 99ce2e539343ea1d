/* The service on a private bus: the methods of the policy and of credentials. */
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/contract.h"
#include "tests/firmware/rigs/bus_rig.h"

static const char policy[] =
    "{\"schedules\":[{\"token\":\"saturday\",\"zone\":\"Europe/Berlin\",\"weekly\":{\"saturday\":"
    "[\"08:00-12:00\"]}}],\"access_points\":[{\"token\":\"front\"}],\"access_profiles\":[{"
    "\"token\":\"staff\",\"policies\":[{\"access_point\":\"front\",\"schedule\":\"saturday\"}]},{"
    "\"token\":\"nobody\"}],\"default_profile\":\"staff\"}";

enum { SATURDAY_9 = 1795248000 /* 2026-11-21, 09:00 in Berlin */, HOUR = 3600 };

static const char *error_of(const struct bus_answer *answer)
{
    const char *dot = strrchr(answer->error, '.');
    return dot ? dot + 1 : answer->error;
}

static struct bus_answer *set_policy(struct bus_rig *f, const char *document, uint64_t revision)
{
    sd_bus_message *message = bus_rig_new_call(f, 1, ISO_CONTRACT_SET_POLICY);
    assert_true(sd_bus_message_append(message, "st", document, revision) >= 0);
    return bus_rig_send(f, 1, message);
}

/* Returns the number of remarks; the last one is copied. */
static int remarks_of(sd_bus_message *reply, char last[200])
{
    const char *text;
    int n = 0;
    assert_true(sd_bus_message_enter_container(reply, 'a', "s") > 0);
    while (sd_bus_message_read(reply, "s", &text) > 0) {
        (void)snprintf(last, 200, "%s", text);
        n++;
    }
    return n;
}

static void a_policy_is_stored_read_and_removed(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    const char *document;
    uint64_t revision = 9;
    char remark[200] = "";
    rig_enrol(f->rig, "ada", 50);
    struct bus_answer *answer = set_policy(f, "{\"doors\": []}", 0);
    assert_string_equal(error_of(answer), "InvalidArgument");
    assert_non_null(strstr(answer->text, "doors"));
    answer = set_policy(f, policy, 0);
    assert_string_equal(answer->error, "");
    assert_true(sd_bus_message_has_signature(answer->reply, "tas"));
    assert_true(sd_bus_message_read(answer->reply, "t", &revision) > 0);
    assert_int_equal(revision, 1);
    assert_int_equal(remarks_of(answer->reply, remark), 0);
    assert_string_equal(error_of(set_policy(f, policy, 0)), "Conflict");

    answer = bus_rig_send(f, 1, bus_rig_new_call(f, 1, ISO_CONTRACT_GET_POLICY));
    assert_true(sd_bus_message_read(answer->reply, "st", &document, &revision) > 0);
    assert_int_equal(revision, 1);
    char kept[1000];
    (void)snprintf(kept, sizeof kept, "%s", document);
    answer = set_policy(f, kept, 1); /* what was read can be stored */
    assert_string_equal(answer->error, "");

    answer = set_policy(f, "", 2);
    assert_true(sd_bus_message_read(answer->reply, "t", &revision) > 0);
    assert_int_equal(revision, 0);
    answer = bus_rig_send(f, 1, bus_rig_new_call(f, 1, ISO_CONTRACT_GET_POLICY));
    assert_true(sd_bus_message_read(answer->reply, "st", &document, &revision) > 0);
    assert_string_equal(document, "");
}

static const char *set_credential(struct bus_rig *f, const char *person, const char *patch)
{
    static char text[512];
    const char *json = "";
    sd_bus_message *message = bus_rig_new_call(f, 1, ISO_CONTRACT_SET_CREDENTIAL);
    assert_true(sd_bus_message_append(message, "ss", person, patch) >= 0);
    struct bus_answer *answer = bus_rig_send(f, 1, message);
    if (answer->error[0]) {
        return error_of(answer);
    }
    assert_true(sd_bus_message_read(answer->reply, "s", &json) > 0);
    (void)snprintf(text, sizeof text, "%s", json);
    return text;
}

static void a_finding_names_the_person(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    char remark[200] = "";
    rig_enrol(f->rig, "ada", 50);
    rig_enrol(f->rig, "bob", 70);
    assert_string_equal(set_policy(f, policy, 0)->error, "");
    (void)set_credential(f, "bob", "{\"profiles\": [\"nobody\"]}");
    struct bus_answer *answer = bus_rig_send(f, 1,
                                             bus_rig_new_call(f, 1, ISO_CONTRACT_CHECK_POLICY));
    assert_true(sd_bus_message_has_signature(answer->reply, "as"));
    assert_int_equal(remarks_of(answer->reply, remark), 1);
    assert_non_null(strstr(remark, "\"bob\""));
}

static void credentials_are_changed_and_listed(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    const char *name, *json;
    rig_enrol(f->rig, "ada", 50);
    rig_enrol(f->rig, "bob", 70);
    assert_string_equal(set_credential(f, "zac", "{}"), "NoSuchPerson");
    assert_string_equal(set_credential(f, "bob", "{\"pin\": \"1\"}"), "InvalidArgument");
    const char *text = set_credential(f, "BOB", "{\"cards\": [\"17/4711\"], \"pin\": \"2580\"}");
    assert_non_null(strstr(text, "\"cards\":[\"17/4711\"],\"pin\":true"));
    assert_string_equal(set_credential(f, "ada", "{\"cards\": [\"17/4711\"]}"), "NameInUse");
    struct bus_answer *answer = bus_rig_send(f, 1,
                                             bus_rig_new_call(f, 1, ISO_CONTRACT_LIST_CREDENTIALS));
    assert_true(sd_bus_message_enter_container(answer->reply, 'a', "(ss)") > 0);
    assert_true(sd_bus_message_read(answer->reply, "(ss)", &name, &json) > 0);
    assert_string_equal(name, "bob");
    assert_non_null(strstr(json, "17/4711"));
    assert_null(strstr(json, "2580"));
    assert_int_equal(sd_bus_message_at_end(answer->reply, 0), 1);
}

/* "OUTCOME REASON WANTED... (level LEVEL at POINT)" */
static const char *test_access(struct bus_rig *f, const char *person, const char *point,
                               int64_t time_s, const char *shown)
{
    static char text[256];
    const char *key, *value;
    sd_bus_message *message = bus_rig_new_call(f, 1, ISO_CONTRACT_TEST_ACCESS);
    assert_true(sd_bus_message_append(message, "ssx", person, point, time_s) >= 0);
    assert_true(sd_bus_message_append(message, "as", *shown ? 1 : 0, shown) >= 0);
    struct bus_answer *answer = bus_rig_send(f, 1, message);
    if (answer->error[0]) {
        return error_of(answer);
    }
    text[0] = '\0';
    assert_true(sd_bus_message_enter_container(answer->reply, 'a', "{sv}") > 0);
    while (sd_bus_message_enter_container(answer->reply, 'e', "sv") > 0) {
        assert_true(sd_bus_message_read(answer->reply, "s", &key) > 0);
        if (strcmp(key, "wanted") == 0) {
            assert_true(sd_bus_message_enter_container(answer->reply, 'v', "as") > 0);
            assert_true(sd_bus_message_enter_container(answer->reply, 'a', "s") > 0);
            while (sd_bus_message_read(answer->reply, "s", &value) > 0) {
                (void)snprintf(text + strlen(text), sizeof text - strlen(text), " +%s", value);
            }
            assert_true(sd_bus_message_exit_container(answer->reply) > 0);
            assert_true(sd_bus_message_exit_container(answer->reply) > 0);
        } else if (strcmp(key, "companion") == 0) {
            assert_true(sd_bus_message_skip(answer->reply, "v") > 0);
        } else {
            assert_true(sd_bus_message_read(answer->reply, "v", "s", &value) > 0);
            (void)snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s",
                           *text ? " " : "", value);
        }
        assert_true(sd_bus_message_exit_container(answer->reply) > 0);
    }
    return text;
}

static void a_test_says_what_the_door_would_decide(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    rig_enrol(f->rig, "ada", 50);
    assert_string_equal(test_access(f, "ada", "", SATURDAY_9, "face"), "allow   ");
    assert_string_equal(set_policy(f, policy, 0)->error, "");
    assert_string_equal(test_access(f, "ada", "", SATURDAY_9, "face"), "allow  face front");
    assert_string_equal(test_access(f, "ada", "front", SATURDAY_9, ""), "want  +face face front");
    assert_string_equal(test_access(f, "ada", "", SATURDAY_9 + 3 * HOUR, "face"),
                        "deny NotPermittedAtThisTime face front");
    assert_string_equal(test_access(f, "ada", "", SATURDAY_9 - HOUR - 1, "face"),
                        "deny NotPermittedAtThisTime face front");
    assert_string_equal(test_access(f, "zac", "", SATURDAY_9, "face"), "NoSuchPerson");
    assert_string_equal(test_access(f, "ada", "back", SATURDAY_9, "face"), "InvalidArgument");
    assert_string_equal(test_access(f, "ada", "", SATURDAY_9, "shoe"), "InvalidArgument");
    assert_string_equal(bus_rig_news(f, 0), ""); /* nobody was let in */
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, bus_rig_setup, bus_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_policy_is_stored_read_and_removed),
        TEST(a_finding_names_the_person),
        TEST(credentials_are_changed_and_listed),
        TEST(a_test_says_what_the_door_would_decide),
    };
    return cmocka_run_group_tests(tests, bus_rig_group_setup, bus_rig_group_teardown);
}
