/* Which names are one: folded without regard to case and encoding. */
#include <errno.h>
#include <string.h>

#include "tests/firmware/cmocka_headers.h"

#include "firmware/person_name.h"

static struct iso_person_name_key key_of(const char *name)
{
    struct iso_person_name_key key;
    memset(&key, 0, sizeof key);
    assert_int_equal(iso_person_name_key(name, &key), 0);
    return key;
}

static bool are_one(const char *a, const char *b)
{
    const struct iso_person_name_key one = key_of(a), other = key_of(b);
    return iso_person_name_key_is_same(&one, &other);
}

static void case_and_encoding_do_not_tell_names_apart(void **state)
{
    static const char *const pairs[][2] = {
        {"Ada", "ada"},
        {"ADA LOVELACE", "Ada Lovelace"},
        {"Stra\u00dfe", "STRASSE"},
        {"\u00c9lodie", "\u00e9lodie"},   /* E with acute, both cases */
        {"\u00e9lodie", "e\u0301lodie"},  /* composed, decomposed */
        {"\uff21\uff44\uff41", "ada"},    /* full-width letters: not by the short way */
        {"\u0391\u03a3", "\u03b1\u03c2"}, /* sigma at the end of a word */
        {"\u0416\u0435\u043d\u044f", "\u0436\u0415\u041d\u042f"},
        {"\u3392", "mhz"},       /* letters with a case by normalisation only */
        {"o\ufb03ce", "OFFICE"}, /* a ligature */
    };
    (void)state;
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        if (!are_one(pairs[i][0], pairs[i][1])) {
            fail_msg("'%s' and '%s' are two names", pairs[i][0], pairs[i][1]);
        }
    }
}

static void other_names_are_others(void **state)
{
    (void)state;
    assert_false(are_one("Ada", "Adam"));
    assert_false(are_one("Ada", "Ad a"));
    assert_false(are_one("Zo\u00eb", "Zoe")); /* an accent tells names apart */
    assert_false(are_one("[", "{"));          /* 0x20 apart, and no letters */
    assert_false(are_one("@", "`"));
}

static void what_is_no_utf8_has_no_key(void **state)
{
    struct iso_person_name_key key, before;
    (void)state;
    memset(&key, 7, sizeof key);
    before = key;
    assert_int_equal(iso_person_name_key("a\xff", &key), -EINVAL);
    assert_memory_equal(&key, &before, sizeof key);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(case_and_encoding_do_not_tell_names_apart),
        cmocka_unit_test(other_names_are_others),
        cmocka_unit_test(what_is_no_utf8_has_no_key),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
