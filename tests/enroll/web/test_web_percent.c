/* Percent-decoding and queries. */
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/web/http/percent.h"

static void texts_are_decoded(void **state)
{
    static const struct {
        const char *text, *path, *form; /* NULL: refused */
    } cases[] = {
        {"", "", ""},
        {"ada", "ada", "ada"},
        {"a+b", "a+b", "a b"},
        {"%41%2f%2B", "A/+", "A/+"},
        {"J%C3%BCrgen", "J\xc3\xbcrgen", "J\xc3\xbcrgen"},
        {"\xc3\xbc", "\xc3\xbc", "\xc3\xbc"},
        {"%25%32%35", "%25", "%25"}, /* decoded once, not twice */
        {"%", NULL, NULL},
        {"%4", NULL, NULL},
        {"%4g", NULL, NULL},
        {"%g4", NULL, NULL},
        {"%+1", NULL, NULL},
        {"a%00b", NULL, NULL},
        {"%80", NULL, NULL},
        {"%C3", NULL, NULL},
        {"%C0%AF", NULL, NULL},    /* overlong '/' */
        {"%ED%A0%80", NULL, NULL}, /* a surrogate */
    };
    char text[32];
    (void)state;

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        for (int is_form = 0; is_form < 2; is_form++) {
            const char *expected = is_form ? cases[i].form : cases[i].path;
            (void)snprintf(text, sizeof text, "%s", cases[i].text);
            assert_int_equal(web_percent_decode(text, is_form), expected != NULL);
            if (expected) {
                assert_string_equal(text, expected);
            }
        }
    }
}

static void queries_are_read(void **state)
{
    char text[] = "first=12&name=a+b%26c&empty=&flag&&eq=a=b";
    struct web_query query;
    (void)state;

    assert_true(web_query_read(text, &query));
    assert_int_equal(query.n, 5);
    assert_string_equal(web_query_find(&query, "first"), "12");
    assert_string_equal(web_query_find(&query, "name"), "a b&c");
    assert_string_equal(web_query_find(&query, "empty"), "");
    assert_string_equal(web_query_find(&query, "flag"), "");
    assert_string_equal(web_query_find(&query, "eq"), "a=b");
    assert_null(web_query_find(&query, "Name"));
    assert_null(web_query_find(&query, "b"));
}

static void damaged_queries_change_nothing(void **state)
{
    static const char *const wrong[] = {"a=%", "%zz=1", "a=1&b=%00", "a=1&a=2", "a&%61"};
    char text[256];
    struct web_query query = {.n = 77};
    (void)state;

    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        (void)snprintf(text, sizeof text, "%s", wrong[i]);
        assert_false(web_query_read(text, &query));
        assert_int_equal(query.n, 77);
    }
    text[0] = '\0';
    for (int i = 0; i < WEB_QUERY_MOST; i++) {
        (void)snprintf(text + strlen(text), sizeof text - strlen(text), "k%d=%d&", i, i);
    }
    char more[300];
    (void)snprintf(more, sizeof more, "%sk=1", text);
    assert_false(web_query_read(more, &query));
    assert_true(web_query_read(text, &query));
    assert_int_equal(query.n, WEB_QUERY_MOST);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texts_are_decoded),
        cmocka_unit_test(queries_are_read),
        cmocka_unit_test(damaged_queries_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
