/* Text from people that goes into the log: UTF-8, names, JSON lines. */
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/utf8.h"
#include "firmware/contract/json_line.h"
#include "firmware/contract/person_name.h"

static void decodes_utf8(void **state)
{
    uint32_t c = 0;
    (void)state;
    assert_int_equal(iso_utf8_decode("A", &c), 1);
    assert_int_equal(c, 'A');
    assert_int_equal(iso_utf8_decode("\xc3\xa9", &c), 2);
    assert_int_equal(c, 0xe9);
    assert_int_equal(iso_utf8_decode("\xe2\x82\xac", &c), 3);
    assert_int_equal(c, 0x20ac);
    assert_int_equal(iso_utf8_decode("\xf0\x9f\x98\x80", &c), 4);
    assert_int_equal(c, 0x1f600);
    assert_int_equal(iso_utf8_decode("\xf4\x8f\xbf\xbf", &c), 4);
    assert_int_equal(c, 0x10ffff);
}

static void refuses_what_is_no_utf8(void **state)
{
    static const char *const bad[] = {
        "\x80",             /* a continuation byte */
        "\xc0\xaf",         /* overlong '/' */
        "\xe0\x80\xaf",     /* overlong, three bytes */
        "\xf0\x80\x80\xaf", /* overlong, four */
        "\xed\xa0\x80",     /* surrogate */
        "\xf4\x90\x80\x80", /* beyond the last character */
        "\xf5\x80\x80\x80",
        "\xff",
        "\xe2\x82",
        "\xc3(",
        "\xf0\x9f\x98",
    };
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        uint32_t c = 4711;
        assert_int_equal(iso_utf8_decode(bad[i], &c), 0);
        assert_int_equal(c, 4711);
    }
}

static void takes_names(void **state)
{
    char longest[ISO_PERSON_NAME_SIZE] = "";
    (void)state;
    assert_null(iso_person_name_flaw("a"));
    assert_null(iso_person_name_flaw("Zo\xc3\xab van \"Q\" \\ 3"));
    for (int i = 0; i < 64; i++) {
        strcat(longest, "\xf0\x9f\x98\x80");
    }
    assert_int_equal(strlen(longest), ISO_PERSON_NAME_SIZE - 1);
    assert_null(iso_person_name_flaw(longest));
}

static void refuses_names(void **state)
{
    static const struct {
        const char *name, *flaw;
    } bad[] = {
        {"", "the name is empty"},
        {" anna", "the name begins with a blank"},
        {"anna ", "the name ends with a blank"},
        {" ", "the name begins with a blank"},
        {"an\nna", "the name holds a control character"},
        {"anna\x7f", "the name holds a control character"},
        {"an\xc2\x85na", "the name holds a control character"},
        {"an\xe2\x80\xaena",
         "the name holds a control character"}, /* the text after it runs from right to left */
        {"an\xffna", "the name is not UTF-8"},
        {"12345678901234567890123456789012345678901234567890123456789012345",
         "the name is longer than 64 characters"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_string_equal(iso_person_name_flaw(bad[i].name), bad[i].flaw);
    }
}

static void writes_json(void **state)
{
    struct iso_json_line line;
    (void)state;
    iso_json_line_begin(&line);
    iso_json_line_integer(&line, "least", INT64_MIN);
    iso_json_line_number(&line, "pi", 3.14159265);
    iso_json_line_number(&line, "nan", NAN);
    iso_json_line_string(&line, "text", "q\" b\\ n\n d\x7f e\xc3\xa9 bad\xff.");
    const size_t length = iso_json_line_end(&line);
    assert_int_equal(length, strlen(line.text));
    assert_string_equal(line.text,
                        "{\"least\":-9223372036854775808,\"pi\":3.14159,\"nan\":null,"
                        "\"text\":\"q\\\" b\\\\ n\\u000a d\\u007f e\xc3\xa9 bad\\ufffd.\"}\n");
}

static void says_when_a_line_is_too_long(void **state)
{
    struct iso_json_line line;
    char text[sizeof line.text];
    (void)state;
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    iso_json_line_begin(&line);
    iso_json_line_string(&line, "text", text);
    assert_int_equal(iso_json_line_end(&line), 0);
    iso_json_line_begin(&line);
    assert_int_equal(iso_json_line_end(&line), 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decodes_utf8), cmocka_unit_test(refuses_what_is_no_utf8),
        cmocka_unit_test(takes_names),  cmocka_unit_test(refuses_names),
        cmocka_unit_test(writes_json),  cmocka_unit_test(says_when_a_line_is_too_long),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
