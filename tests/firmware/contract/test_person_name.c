/* Which names are equal: they are folded without regard to case, encoding and invisible characters.
 * Which characters a name may have. */
#include <errno.h>
#include <string.h>
#include <unistr.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/person_name.h"

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
        {"\uff21\uff44\uff41", "ada"},    /* full-width letters, which are not ASCII */
        {"\u0391\u03a3", "\u03b1\u03c2"}, /* sigma at the end of a word */
        {"\u0416\u0435\u043d\u044f", "\u0436\u0415\u041d\u042f"},
        {"\u3392", "mhz"},       /* letters that get a case by normalisation only */
        {"o\ufb03ce", "OFFICE"}, /* a ligature */
        /* invisible characters: soft hyphen, zero-width space and joiner, word joiner, Hangul
         * filler */
        {"A\u00adda", "ada"},
        {"Ad\u200ba", "ada"},
        {"Ada\u200d", "ada"},
        {"\u2060Ada", "ada"},
        {"Ada\u3164", "ada"},
        {"Ada\uffa0", "ada"},
        {"e\u034f\u0301lodie", "\u00e9lodie"}, /* between a letter and its accent */
        {"Ada\ufe0f", "ada"},                  /* a variation selector */
        {"Ada\U000e0041", "ada"},              /* a tag */
        {"\u061cAda", "ada"},                  /* a mark of direction */
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
    assert_false(are_one("Zo\u00eb", "Zoe")); /* an accent makes a different name */
    assert_false(are_one("[", "{"));          /* 0x20 apart, but no letters */
    assert_false(are_one("@", "`"));
}

/* An earlier version may have stored such a name, so it also has a key. */
static void an_invisible_name_has_a_key(void **state)
{
    (void)state;
    assert_true(are_one("\u200b", "\u2060\u200b"));
    assert_false(are_one("\u200b", "a"));
}

/* Every character that Unicode lists as default-ignorable, and every character of the other
 * invisible kinds. */
static void refuses_invisible_characters(void **state)
{
    static const struct {
        uint32_t first, last;
    } ranges[] = {
        {0xad, 0xad},       {0x34f, 0x34f},   {0x61c, 0x61c},     {0x115f, 0x1160},
        {0x17b4, 0x17b5},   {0x180b, 0x180f}, {0x200b, 0x200f},   {0x202a, 0x202e},
        {0x2060, 0x206f},   {0x3164, 0x3164}, {0xfe00, 0xfe0f},   {0xfeff, 0xfeff},
        {0xffa0, 0xffa0},   {0xfff0, 0xfffb}, {0x1bca0, 0x1bca3}, {0x1d173, 0x1d17a},
        {0xe0000, 0xe0fff}, {0x2800, 0x2800}, {0xfdd0, 0xfdef},   {0xfffe, 0xffff},
    };
    size_t n = 0;
    (void)state;
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++) {
        for (uint32_t c = ranges[i].first; c <= ranges[i].last; c++, n++) {
            uint8_t name[16] = "Ad";
            const int length = u8_uctomb(name + 2, c, 8);
            assert_true(length > 0);
            memcpy(name + 2 + length, "a", 2);
            if (!iso_person_name_flaw((const char *)name)) {
                fail_msg("U+%04X is accepted", (unsigned)c);
            }
        }
    }
    print_message("%zu characters\n", n);
}

/* Letters of many scripts, marks that belong to them, and blanks inside a name are visible. */
static void accepts_letters(void **state)
{
    static const char *const names[] = {"Zo\u00eb",
                                        "Jose\u0301 Garc\u00eda",
                                        "\u5f20\u4f1f",
                                        "\u0416\u0435\u043d\u044f",
                                        "\u0645\u062d\u0645\u062f",
                                        "\u05d3\u05d5\u05d3",
                                        "\u0906\u0930\u094d\u092f\u0928",
                                        "\uae40\ubbfc\uc900",
                                        "O\u2019Brien",
                                        "Ada\u00a0L.",
                                        "\U0001f600"};
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        assert_null(iso_person_name_flaw(names[i]));
    }
}

static void stored_names_of_earlier_versions_are_kept(void **state)
{
    (void)state;
    assert_string_equal(iso_person_name_flaw("A\u200bda"), "the name holds an invisible character");
    assert_true(iso_person_name_can_be_stored("A\u200bda"));
    assert_true(iso_person_name_can_be_stored("Ada\u2800"));
    assert_false(iso_person_name_can_be_stored("A\nda"));
    assert_false(iso_person_name_can_be_stored("A\u202eda"));
    assert_false(iso_person_name_can_be_stored(""));
    assert_false(iso_person_name_can_be_stored("a\xff"));
    assert_string_equal(iso_person_name_flaw("Ada\u202f"), "the name ends with a blank");
    assert_string_equal(iso_person_name_flaw("\u205fAda"), "the name begins with a blank");
}

static void text_that_is_no_utf8_has_no_key(void **state)
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
        cmocka_unit_test(text_that_is_no_utf8_has_no_key),
        cmocka_unit_test(an_invisible_name_has_a_key),
        cmocka_unit_test(refuses_invisible_characters),
        cmocka_unit_test(accepts_letters),
        cmocka_unit_test(stored_names_of_earlier_versions_are_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
