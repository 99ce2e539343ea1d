/* The method RecordCommission: each item and the outcome are on record, and nothing is on record if
 * the call is refused. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/contract.h"
#include "tests/firmware/rigs/bus_rig.h"

struct item {
    const char *item, *answer, *remark;
};

/* Calls RecordCommission. Returns the answer. */
static struct bus_answer *record(struct bus_rig *f, const char *by, const struct item *items,
                                 size_t n)
{
    sd_bus_message *call = bus_rig_new_call(f, 0, ISO_CONTRACT_RECORD_COMMISSION);
    assert_true(sd_bus_message_append(call, "s", by) >= 0);
    assert_true(sd_bus_message_open_container(call, 'a', "(sss)") >= 0);
    for (size_t i = 0; i < n; i++) {
        assert_true(sd_bus_message_append(call, "(sss)", items[i].item, items[i].answer,
                                          items[i].remark) >= 0);
    }
    assert_true(sd_bus_message_close_container(call) >= 0);
    return bus_rig_send(f, 0, call);
}

/* Reads one record of the log, over the bus. The text is valid until the next call. */
static const char *read_record(struct bus_rig *f, uint64_t sequence)
{
    static char line[1024];
    const char *text = NULL;
    sd_bus_message *call = bus_rig_new_call(f, 0, ISO_CONTRACT_READ_LOG);
    assert_true(sd_bus_message_append(call, "tu", sequence, 1) >= 0);
    struct bus_answer *answer = bus_rig_send(f, 0, call);
    assert_string_equal(answer->error, "");
    assert_true(sd_bus_message_enter_container(answer->reply, 'a', "s") > 0);
    assert_true(sd_bus_message_read(answer->reply, "s", &text) > 0);
    (void)snprintf(line, sizeof line, "%s", text);
    return line;
}

/* Records items, expects this outcome, and returns the sequence of its record. */
static uint64_t expect_outcome(struct bus_rig *f, const struct item *items, size_t n,
                               const char *expected)
{
    const char *outcome = NULL;
    uint64_t sequence = 0;
    struct bus_answer *answer = record(f, "Ada Example", items, n);
    assert_string_equal(answer->error, "");
    assert_true(sd_bus_message_read(answer->reply, "st", &outcome, &sequence) > 0);
    assert_string_equal(outcome, expected);
    return sequence;
}

static void every_item_is_on_record_and_then_the_outcome(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    static const struct item items[] = {
        {"sensor", "ok", "started"}, {"photo", "yes", ""}, {"tamper", "skipped", "no \"switch\""}};
    const uint64_t before = iso_audit_last(f->rig->audit);
    const uint64_t last = expect_outcome(f, items, 3, "incomplete");
    char note[128];
    assert_int_equal(last, before + 4);
    assert_int_equal(last, iso_audit_last(f->rig->audit));
    const char *line = read_record(f, before + 1);
    assert_non_null(strstr(line, "\"event\":\"commission\""));
    assert_non_null(strstr(line, "\"reason\":\"ok\""));
    assert_non_null(strstr(line, "\"note\":\"sensor: started\""));
    line = read_record(f, before + 2);
    assert_non_null(strstr(line, "\"reason\":\"yes\""));
    assert_non_null(strstr(line, "\"note\":\"photo\""));
    line = read_record(f, before + 3);
    assert_non_null(strstr(line, "\"note\":\"tamper: no \\\"switch\\\"\""));
    line = read_record(f, last);
    (void)snprintf(note, sizeof note, "\"note\":\"3 items, asked by user %u for Ada Example\"",
                   (unsigned)geteuid());
    assert_non_null(strstr(line, "\"event\":\"commission\""));
    assert_non_null(strstr(line, "\"reason\":\"incomplete\""));
    assert_non_null(strstr(line, note));
}

/* The worst answer decides, whatever comes after it. */
static void the_outcome_follows_from_the_answers(void **state)
{
    static const struct {
        const char *answers[3], *outcome;
    } cases[] = {
        {{"ok", "yes", "ok"}, "passed"},         {{"ok", "warning", "yes"}, "incomplete"},
        {{"skipped", "ok", "ok"}, "incomplete"}, {{"fault", "yes", "skipped"}, "failed"},
        {{"ok", "no", "warning"}, "failed"},
    };
    struct bus_rig *f = bus_rig_need(state);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct item items[] = {{"sensor", cases[i].answers[0], ""},
                                     {"photo", cases[i].answers[1], ""},
                                     {"cable", cases[i].answers[2], ""}};
        (void)expect_outcome(f, items, 3, cases[i].outcome);
    }
}

static void a_call_that_is_refused_records_nothing(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    static char long_remark[ISO_CONTRACT_REMARK_BYTES + 2];
    const uint64_t before = iso_audit_last(f->rig->audit);
    memset(long_remark, 'a', sizeof long_remark - 1);
    const struct {
        const char *by, *error;
        struct item item;
    } cases[] = {
        {"", ISO_CONTRACT_ERROR_INVALID_NAME, {"photo", "yes", ""}},
        {"a\nb", ISO_CONTRACT_ERROR_INVALID_NAME, {"photo", "yes", ""}},
        {"Ada", ISO_CONTRACT_ERROR_INVALID_ARGUMENT, {"", "yes", ""}},
        {"Ada", ISO_CONTRACT_ERROR_INVALID_ARGUMENT, {"a photo", "yes", ""}},
        {"Ada", ISO_CONTRACT_ERROR_INVALID_ARGUMENT, {"photo", "maybe", ""}},
        {"Ada", ISO_CONTRACT_ERROR_INVALID_ARGUMENT, {"photo", "", ""}},
        {"Ada", ISO_CONTRACT_ERROR_INVALID_ARGUMENT, {"photo", "no", "one\ntwo"}},
        {"Ada", ISO_CONTRACT_ERROR_INVALID_ARGUMENT, {"photo", "no", long_remark}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct item items[] = {{"sensor", "ok", ""}, cases[i].item};
        assert_string_equal(record(f, cases[i].by, items, 2)->error, cases[i].error);
    }
    assert_string_equal(record(f, "Ada", NULL, 0)->error, ISO_CONTRACT_ERROR_INVALID_ARGUMENT);
    struct item many[ISO_CONTRACT_ITEMS_MAX + 1];
    for (size_t i = 0; i < ISO_CONTRACT_ITEMS_MAX + 1; i++) {
        many[i] = (struct item){"photo", "yes", ""};
    }
    assert_string_equal(record(f, "Ada", many, ISO_CONTRACT_ITEMS_MAX + 1)->error,
                        ISO_CONTRACT_ERROR_INVALID_ARGUMENT);
    assert_int_equal(iso_audit_last(f->rig->audit), before);
    assert_string_equal(record(f, "Ada", many, ISO_CONTRACT_ITEMS_MAX)->error, "");
}

/* A disk that refuses the records leaves no outcome behind. */
static void a_log_that_cannot_be_written_has_no_outcome(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    static const struct item items[] = {{"sensor", "ok", ""}};
    const uint64_t before = iso_audit_last(f->rig->audit);
    rig_fill_disk();
    assert_string_not_equal(record(f, "Ada", items, 1)->error, "");
    rig_free_disk();
    assert_int_equal(iso_audit_last(f->rig->audit), before);
    (void)expect_outcome(f, items, 1, "passed");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, bus_rig_setup, bus_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(every_item_is_on_record_and_then_the_outcome),
        TEST(the_outcome_follows_from_the_answers),
        TEST(a_call_that_is_refused_records_nothing),
        TEST(a_log_that_cannot_be_written_has_no_outcome),
    };
    return cmocka_run_group_tests(tests, bus_rig_group_setup, bus_rig_group_teardown);
}
