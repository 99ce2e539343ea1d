/* Limits of validity: the result of a change, refused changes, and their text. */
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/validity.h"

enum { NOW = 1795250000 }; /* 2026-11-21T08:33:20Z */

static const struct iso_validity december = {1796083200, 1798761599};

static void a_limit_that_is_not_named_stays(void **state)
{
    const struct iso_validity_change nothing = {0};
    const struct iso_validity_change end = {.names_until = true, .limits = {5, 1796169600}};
    const struct iso_validity_change none = {.names_from = true, .names_until = true};
    (void)state;
    struct iso_validity after = iso_validity_after(&december, &nothing);
    assert_true(iso_validity_is_same(&after, &december));
    after = iso_validity_after(&december, &end);
    assert_int_equal(after.from_s, december.from_s);
    assert_int_equal(after.until_s, 1796169600);
    assert_false(iso_validity_is_same(&after, &december));
    after = iso_validity_after(&december, &none);
    assert_int_equal(after.from_s, 0);
    assert_int_equal(after.until_s, 0);
}

static void expect_flaw(const struct iso_validity_change *change, int64_t now_s, const char *wanted)
{
    char flaw[ISO_VALIDITY_FLAW_SIZE] = "";
    assert_int_equal(iso_validity_is_fine(&december, change, now_s, flaw), !*wanted);
    assert_string_equal(flaw, wanted);
}

static void refuses_impossible_limits(void **state)
{
    struct iso_validity_change change = {.names_until = true, .limits = {0, december.from_s}};
    (void)state;
    expect_flaw(&change, NOW, "the time of validity is empty"); /* with the stored beginning */
    change.names_from = true;
    expect_flaw(&change, NOW, "");
    change.limits.from_s = -1;
    expect_flaw(&change, NOW, "the time of validity is before 1970");
}

static void an_end_in_the_past_must_be_confirmed(void **state)
{
    struct iso_validity_change change = {
        .names_from = true, .names_until = true, .limits = {0, NOW - 1}};
    (void)state;
    expect_flaw(
        &change, NOW,
        "the time of validity ended in the past, 2026-11-21T08:33:19Z (--expired accepts it)");
    change.limits.until_s = NOW;
    expect_flaw(&change, NOW, "");
    change.limits.until_s = NOW - 1;
    change.expired = true;
    expect_flaw(&change, NOW, "");
    change.expired = false;
    expect_flaw(&change, 86400, ""); /* a clock that was never set does not count */
    const struct iso_validity_change past_end_is_stored = {.names_from = true, .limits = {5, 0}};
    expect_flaw(&past_end_is_stored, december.until_s + 1,
                ""); /* the change does not name this limit */
}

static void reads_as_words(void **state)
{
    static const struct {
        struct iso_validity validity;
        const char *text;
    } cases[] = {
        {{0, 0}, "no limits"},
        {{1796083200, 0}, "from 2026-12-01T00:00:00Z"},
        {{0, 1798761599}, "until 2026-12-31T23:59:59Z"},
        {{1796083200, 1798761599}, "from 2026-12-01T00:00:00Z until 2026-12-31T23:59:59Z"},
    };
    char text[ISO_VALIDITY_TEXT_SIZE];
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        iso_validity_text(&cases[i].validity, text);
        assert_string_equal(text, cases[i].text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_limit_that_is_not_named_stays),
        cmocka_unit_test(refuses_impossible_limits),
        cmocka_unit_test(an_end_in_the_past_must_be_confirmed),
        cmocka_unit_test(reads_as_words),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
