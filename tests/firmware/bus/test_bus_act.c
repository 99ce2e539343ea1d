/* The method RecordAct: a client puts on record for whom it acts, or learns that it must not act.
 * And the consent of an enrolment, which the daemon records. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/contract.h"
#include "tests/firmware/rigs/bus_rig.h"

/* Calls RecordAct. Returns the last part of the error's name, or "". */
static const char *record(struct bus_rig *f, const char *account, const char *act,
                          const char *person)
{
    sd_bus_message *call = bus_rig_new_call(f, 0, ISO_CONTRACT_RECORD_ACT);
    assert_true(sd_bus_message_append(call, "sss", account, act, person) >= 0);
    const struct bus_answer *answer = bus_rig_send(f, 0, call);
    return *answer->error ? strrchr(answer->error, '.') + 1 : "";
}

/* Reads the last record of the log, over the bus. */
static void last_record(struct bus_rig *f, char *out, size_t size)
{
    const char *text = NULL;
    sd_bus_message *call = bus_rig_new_call(f, 0, ISO_CONTRACT_READ_LOG);
    assert_true(sd_bus_message_append(call, "tu", iso_audit_last(f->rig->audit), 1) >= 0);
    struct bus_answer *answer = bus_rig_send(f, 0, call);
    assert_string_equal(answer->error, "");
    assert_true(sd_bus_message_enter_container(answer->reply, 'a', "s") > 0);
    assert_true(sd_bus_message_read(answer->reply, "s", &text) > 0);
    (void)snprintf(out, size, "%s", text);
}

static void an_act_is_on_record_with_account_user_and_person(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    char line[1024], note[128];
    assert_string_equal(record(f, "ada", "remove", "Grace"), "");
    last_record(f, line, sizeof line);
    (void)snprintf(note, sizeof note, "\"note\":\"remove, asked by ada of user %u\"",
                   (unsigned)geteuid());
    assert_non_null(strstr(line, "\"event\":\"act\""));
    assert_non_null(strstr(line, "\"person\":\"Grace\""));
    assert_non_null(strstr(line, note));
    assert_string_equal(record(f, "ada", "log-in", ""), "");
    last_record(f, line, sizeof line);
    assert_null(strstr(line, "\"person\""));
}

static void words_that_could_mislead_a_reader_are_refused(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    const uint64_t before = iso_audit_last(f->rig->audit);
    static const char *const words[] = {
        "", "two words", "Ada", "a,b", "a\nb", "\xc3\xa4", "abcdefghijklmnopqrstuvwxyz0123456"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        assert_string_equal(record(f, words[i], "remove", ""), "InvalidArgument");
        assert_string_equal(record(f, "ada", words[i], ""), "InvalidArgument");
    }
    assert_string_equal(record(f, "ada", "remove", "a\nb"), "InvalidName");
    assert_int_equal(iso_audit_last(f->rig->audit), before);
    assert_string_equal(record(f, "abcdefghijklmnopqrstuvwxyz012345", "remove", ""), "");
}

/* Calls EnrollStart for a person who consents, or not. Returns as record() does. */
static const char *enroll(struct bus_rig *f, const char *person, bool consent)
{
    sd_bus_message *call = bus_rig_new_call(f, 0, ISO_CONTRACT_ENROLL_START);
    assert_true(sd_bus_message_append(call, "sa{sv}", person, 1, ISO_CONTRACT_CONSENT, "b",
                                      (int)consent) >= 0);
    const struct bus_answer *answer = bus_rig_send(f, 0, call);
    return *answer->error ? strrchr(answer->error, '.') + 1 : "";
}

static void a_consent_is_on_record_before_the_enrolment_begins(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    const uint64_t before = iso_audit_last(f->rig->audit);
    char line[1024], note[128];
    assert_string_equal(enroll(f, "Grace", true), "ClaimDevice");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(enroll(f, "a\nb", true), "InvalidName");
    assert_int_equal(iso_audit_last(f->rig->audit), before);
    assert_string_equal(enroll(f, "Grace", false), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_ENROLL_STOP, NULL), "");
    last_record(f, line, sizeof line);
    assert_null(strstr(line, "consent"));
    assert_string_equal(enroll(f, "Grace", true), "");
    last_record(f, line, sizeof line);
    (void)snprintf(note, sizeof note, "\"note\":\"consent, asked by user %u\"",
                   (unsigned)geteuid());
    assert_non_null(strstr(line, "\"event\":\"act\""));
    assert_non_null(strstr(line, "\"person\":\"Grace\""));
    assert_non_null(strstr(line, note));
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, bus_rig_setup, bus_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(an_act_is_on_record_with_account_user_and_person),
        TEST(words_that_could_mislead_a_reader_are_refused),
        TEST(a_consent_is_on_record_before_the_enrolment_begins),
    };
    return cmocka_run_group_tests(tests, bus_rig_group_setup, bus_rig_group_teardown);
}
