/* Credentials: what a patch changes and refuses, what clients read, and the stored bytes. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/policy/credential/credential_json.h"

static struct iso_credential_record patched(const char *json)
{
    struct iso_credential_record record = iso_credential_record_new();
    struct iso_fault fault = {.text = ""};
    if (iso_credential_patch(json, &record, &fault)) {
        fail_msg("%s: %s", json, fault.text);
    }
    return record;
}

static void expect_text(const struct iso_credential_record *record, const char *expected)
{
    char *text = iso_credential_text(record);
    assert_string_equal(text, expected);
    free(text);
}

static void a_new_credential_has_nothing(void **state)
{
    const struct iso_credential_record record = patched("{}");
    (void)state;
    expect_text(&record, "{\"enabled\":true,\"disabled_reason\":\"\",\"cards\":[],\"pin\":false,"
                         "\"duress_pin\":false,\"profiles\":[],\"no_antipassback\":false,"
                         "\"needs_escort\":false,\"two_person_class\":0}");
}

static void a_patch_changes_what_it_names(void **state)
{
    struct iso_credential_record record = patched(
        "{\"cards\": [\"17/4711\", \"56:04a2b3c4d5e6f7\"], \"pin\": \"0042\", \"duress_pin\": "
        "\"123456789\", \"profiles\": [\"staff\", \"b\u00fcro\"], \"two_person_class\": 3}");
    (void)state;
    assert_int_equal(record.pin, 10042);
    assert_int_equal(record.duress_pin, 1123456789);
    assert_int_equal(record.cards[0].code, (uint64_t)17 << 32 | 4711);
    assert_int_equal(record.cards[1].bits, 56);
    assert_int_equal(record.cards[1].code, 0x04a2b3c4d5e6f7);
    assert_int_equal(
        iso_credential_patch("{\"duress_pin\": null, \"cards\": [], \"needs_escort\": true, "
                             "\"enabled\": false, \"disabled_reason\": \"lost\"}",
                             &record, NULL),
        0);
    expect_text(&record,
                "{\"enabled\":false,\"disabled_reason\":\"lost\",\"cards\":[],\"pin\":true,"
                "\"duress_pin\":false,\"profiles\":[\"staff\",\"b\u00fcro\"],"
                "\"no_antipassback\":false,\"needs_escort\":true,\"two_person_class\":3}");
}

static void a_wrong_patch_changes_nothing(void **state)
{
    static const struct {
        const char *json, *says;
    } wrong[] = {
        {"", "JSON object"},
        {"[]", "JSON object"},
        {"{\"pin\": \"1234\", \"pin\": \"1235\"}", "JSON object"},
        {"{\"pin\": 1234}", "pin: it must be a text of digits"},
        {"{\"pin\": \"123\"}", "pin: it needs 4 to 9 digits"},
        {"{\"pin\": \"12a4\"}", "pin: it must be a text of digits"},
        {"{\"pin\": \"1234\\u0000\"}", "JSON object"},
        {"{\"duress_pin\": \"1234\"}", "there is no pin"},
        {"{\"pin\": \"1234\", \"duress_pin\": \"1234\"}", "the same as the pin"},
        {"{\"cards\": \"17/1\"}", "cards: it must be an array"},
        {"{\"cards\": [\"17\"]}", "'17' is no card"},
        {"{\"cards\": [\"17/65536\"]}", "is no card"},
        {"{\"cards\": [\"4:1f\"]}", "is no card"},
        {"{\"cards\": [\"65:1f\"]}", "is no card"},
        {"{\"cards\": [\"0:1f\"]}", "is no card"},
        {"{\"cards\": [1]}", "is no card"},
        {"{\"cards\": [\"1/1\", \"1/1\"]}", "1/1 is there twice"},
        {"{\"cards\": [\"1/1\", \"1/2\", \"1/3\", \"1/4\", \"1/5\"]}", "at most 4"},
        {"{\"profiles\": [\"\"]}", "profiles: a name is empty"},
        {"{\"profiles\": [\"a\", \"a\"]}", "a is there twice"},
        {"{\"enabled\": 1}", "enabled: it must be true or false"},
        {"{\"disabled_reason\": \"a text that is longer than thirty-one bytes\"}", "too long"},
        {"{\"disabled_reason\": \"two\\nlines\"}", "not a line of text"},
        {"{\"two_person_class\": 256}", "from 0 to 255"},
        {"{\"face\": true}", "no such member"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct iso_credential_record record = patched("{\"needs_escort\": true}");
        const struct iso_credential_record before = record;
        struct iso_fault fault = {.text = ""};
        assert_int_equal(iso_credential_patch(wrong[i].json, &record, &fault), -EINVAL);
        if (!strstr(fault.text, wrong[i].says)) {
            fail_msg("%s: '%s' does not say '%s'", wrong[i].json, fault.text, wrong[i].says);
        }
        assert_memory_equal(&record, &before, sizeof record);
    }
}

/* Random records come back from their bytes, and no change of a byte makes the reader read beyond
 * the end or return a record that the check refuses. */
static void bytes_come_back(void **state)
{
    (void)state;
    srandom(1);
    for (int round = 0; round < 20000; round++) {
        struct iso_credential_record record = iso_credential_record_new(), back;
        uint8_t bytes[ISO_CREDENTIAL_BYTES_MAX];
        record.enabled = random() % 2;
        record.needs_escort = random() % 2;
        record.two_person_class = (uint8_t)random();
        record.pin = random() % 2 ? 10000 + (uint32_t)(random() % 10000) : 0;
        record.n_cards = (uint8_t)(random() % 3); /* two cards are the same by chance at times */
        for (int i = 0; i < record.n_cards; i++) {
            const uint8_t bits = (uint8_t)(random() % 65);
            const uint64_t code = ((uint64_t)random() << 8 | (uint64_t)i);
            record.cards[i] = (struct iso_card_number){
                bits, bits == 0 ? (code & 0xffff) : code & (UINT64_MAX >> (64 - bits))};
            if (i > 0 && iso_card_number_is_same(&record.cards[i], &record.cards[i - 1])) {
                record.n_cards = (uint8_t)i;
            }
        }
        record.n_profiles = (uint8_t)(random() % (ISO_CREDENTIAL_PROFILES_MAX + 1));
        for (int i = 0; i < record.n_profiles; i++) {
            (void)snprintf(record.profiles[i], ISO_TOKEN_SIZE, "%d-%.*s", i, (int)(random() % 60),
                           "abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuvwxyzabcdefghijklm");
        }
        const size_t size = iso_credential_record_put(&record, bytes);
        assert_int_equal(size % 64, 0);
        assert_int_equal(iso_credential_record_get(bytes, size, &back), 0);
        assert_memory_equal(&back, &record, sizeof back);
        uint8_t *damaged = malloc(size);
        const size_t cut = (size_t)random() % size;
        memcpy(damaged, bytes, size);
        damaged[(size_t)random() % size] ^= (uint8_t)(1 + random() % 255);
        if (iso_credential_record_get(damaged, size, &back) == 0) {
            assert_int_equal(iso_credential_record_check(&back, NULL), 0);
        }
        free(damaged);
        damaged = malloc(cut + 1);
        memcpy(damaged, bytes, cut);
        (void)!iso_credential_record_get(damaged, cut, &back);
        free(damaged);
    }
}

/* The part of a fleet is after everything else, so the bytes of others are as they were before
 * there were fleets. */
static void a_person_of_a_fleet_is_marked(void **state)
{
    struct iso_credential_record record = patched("{\"pin\": \"1234\", \"cards\": [\"17/4711\"]}"),
                                 back;
    uint8_t without[ISO_CREDENTIAL_BYTES_MAX], bytes[ISO_CREDENTIAL_BYTES_MAX];
    (void)state;
    assert_int_equal(iso_credential_record_put(&record, without), 64);
    assert_true(without[1] < 8);
    assert_int_equal(iso_credential_record_get(without, 64, &back), 0);
    assert_false(iso_credential_is_of_fleet(&back));
    record.fleet = (struct iso_credential_fleet){
        .person = {1, 2, 16}, .revision = 77, .zones = 0x81, .offline_ok = true, .templates = {9}};
    const size_t size = iso_credential_record_put(&record, bytes);
    assert_int_equal(bytes[1], without[1] | 8);
    assert_int_equal(iso_credential_record_get(bytes, size, &back), 0);
    assert_true(iso_credential_is_of_fleet(&back));
    assert_memory_equal(&back.fleet, &record.fleet, sizeof back.fleet);
    bytes[1] &= (uint8_t)~8;
    assert_int_equal(iso_credential_record_get(bytes, size, &back), 0);
    assert_false(iso_credential_is_of_fleet(&back));
    bytes[1] |= 16 | 8;
    assert_int_equal(iso_credential_record_get(bytes, size, &back), -EBADMSG);
    without[1] |= 8; /* a part of zeros has no revision */
    assert_int_equal(iso_credential_record_get(without, 64, &back), -EBADMSG);
}

static void a_patch_text_makes_the_same_record(void **state)
{
    struct iso_credential_record record = patched(
        "{\"pin\": \"0042\", \"duress_pin\": \"123456789\", \"cards\": [\"17/4711\"], "
        "\"profiles\": [\"staff\"], \"enabled\": false, \"disabled_reason\": \"lost\"}");
    char *text = iso_credential_patch_text(&record);
    (void)state;
    assert_non_null(strstr(text, "\"pin\":\"0042\""));
    const struct iso_credential_record same = patched(text);
    assert_memory_equal(&same, &record, sizeof same);
    free(text);
    record = iso_credential_record_new();
    text = iso_credential_patch_text(&record);
    const struct iso_credential_record none = patched(text);
    assert_memory_equal(&none, &record, sizeof none);
    free(text);
}

static void a_newer_format_is_named(void **state)
{
    const struct iso_credential_record record = iso_credential_record_new();
    struct iso_credential_record back;
    uint8_t bytes[ISO_CREDENTIAL_BYTES_MAX];
    (void)state;
    const size_t size = iso_credential_record_put(&record, bytes);
    bytes[0]++;
    assert_int_equal(iso_credential_record_get(bytes, size, &back), -EPROTONOSUPPORT);
    assert_int_equal(iso_credential_record_get(bytes, 0, &back), -EBADMSG);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_new_credential_has_nothing),
        cmocka_unit_test(a_patch_changes_what_it_names),
        cmocka_unit_test(a_wrong_patch_changes_nothing),
        cmocka_unit_test(bytes_come_back),
        cmocka_unit_test(a_person_of_a_fleet_is_marked),
        cmocka_unit_test(a_patch_text_makes_the_same_record),
        cmocka_unit_test(a_newer_format_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
