/* Every code of a fault has a name, a meaning and a remedy, and some source raises it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <ctype.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/fault.h"
#include "enroll/cli/doctor/remedy.h"
#include "firmware/contract/fault_tag.h"
#include "tests/support/scratch.h"

static void every_code_has_a_name_of_its_own(void **state)
{
    (void)state;
    for (enum iso_fault_code code = ISO_FAULT_NONE; code < ISO_FAULT_CODES; code++) {
        const char *name = iso_fault_code_name(code);
        enum iso_fault_code found = ISO_FAULT_CODES;
        assert_non_null(name);
        assert_true(strlen(name) > 3 && strlen(name) + 4 <= ISO_FAULT_TAG_SIZE);
        assert_int_equal(strspn(name, "abcdefghijklmnopqrstuvwxyz-"), strlen(name));
        assert_true(iso_fault_code_find(name, &found));
        assert_int_equal(found, code); /* and no other code has this name */
    }
    enum iso_fault_code untouched = ISO_FAULT_DISK_FULL;
    assert_false(iso_fault_code_find("no-such-code", &untouched));
    assert_int_equal(untouched, ISO_FAULT_DISK_FULL);
    assert_null(iso_fault_code_name(ISO_FAULT_CODES));
}

static void every_code_has_a_meaning_and_a_remedy(void **state)
{
    (void)state;
    for (enum iso_fault_code code = ISO_FAULT_NONE; code < ISO_FAULT_CODES; code++) {
        const char *meaning = iso_fault_code_meaning(code), *remedy = cli_remedy(code);
        if (!meaning || meaning[strlen(meaning) - 1] != '.') {
            fail_msg("%s has no meaning that is a sentence", iso_fault_code_name(code));
        }
        /* A fault without a code has only its sentence. */
        if ((remedy && *remedy) != (code != ISO_FAULT_NONE)) {
            fail_msg("the remedy of %s: %s", iso_fault_code_name(code), remedy ? remedy : "none");
        }
    }
    assert_null(iso_fault_code_meaning(ISO_FAULT_CODES));
    assert_null(cli_remedy(ISO_FAULT_CODES));
}

static void a_fault_carries_its_code(void **state)
{
    struct iso_fault fault = {.text = ""}, outer = {.text = ""};
    (void)state;
    assert_int_equal(iso_fault_set_code(&fault, ISO_FAULT_DISK_FULL, -28, "%s: full", "/x"), -28);
    assert_string_equal(fault.text, "/x: full");
    assert_int_equal(fault.code, ISO_FAULT_DISK_FULL);
    (void)iso_fault_set_code(&outer, fault.code, -28, "store: %s", fault.text);
    assert_int_equal(outer.code, ISO_FAULT_DISK_FULL);
    (void)iso_fault_set(&fault, -5, "another one"); /* the old code is removed */
    assert_int_equal(fault.code, ISO_FAULT_NONE);
    assert_int_equal(iso_fault_code_default(&fault, ISO_FAULT_DISK_FAILED, -5), -5);
    assert_int_equal(iso_fault_code_default(&fault, ISO_FAULT_DISK_FULL, -5), -5);
    assert_int_equal(fault.code, ISO_FAULT_DISK_FAILED);
    assert_int_equal(iso_fault_recode(&fault, ISO_FAULT_DISK_FULL, -5), -5);
    assert_int_equal(fault.code, ISO_FAULT_DISK_FULL);
    (void)iso_fault_set(&fault, -12, "no memory");
    assert_int_equal(fault.code, ISO_FAULT_OUT_OF_MEMORY);
    assert_int_equal(iso_fault_recode(NULL, ISO_FAULT_DISK_FULL, -5), -5);
}

static void a_line_of_the_log_ends_with_the_code(void **state)
{
    char tag[ISO_FAULT_TAG_SIZE];
    (void)state;
    assert_string_equal(iso_fault_tag(ISO_FAULT_KEY_WRONG, tag), " [key-wrong]");
    assert_string_equal(iso_fault_tag(ISO_FAULT_NONE, tag), "");
    assert_string_equal(iso_fault_word(ISO_FAULT_KEY_WRONG), "key-wrong");
    assert_string_equal(iso_fault_word(ISO_FAULT_NONE), "");
}

/* ---- the sources that raise them ---- */

static bool raised[ISO_FAULT_CODES];

/* Makes "ISO_FAULT_DISK_FULL" of "disk-full". */
static void spell(enum iso_fault_code code, char text[64])
{
    (void)snprintf(text, 64, "ISO_FAULT_%s", iso_fault_code_name(code));
    for (char *c = text; *c; c++) {
        *c = *c == '-' ? '_' : (char)toupper((unsigned char)*c);
    }
}

static bool has_word(const char *text, const char *word)
{
    const size_t length = strlen(word);
    for (const char *at = text; (at = strstr(at, word)); at += length) {
        if (!isalnum((unsigned char)at[length]) && at[length] != '_') {
            return true;
        }
    }
    return false;
}

/* Returns the bracket that closes a call, or the end of the text. */
static const char *end_of_call(const char *at)
{
    int depth = 0;
    bool quoted = false;
    for (; *at; at++) {
        quoted ^= *at == '"' && at[-1] != '\\';
        depth += quoted ? 0 : (*at == '(') - (*at == ')');
        if (!quoted && *at == ')' && depth == 0) {
            break;
        }
    }
    return at;
}

/* A fault made of another fault's text has that fault's code, too. iso_fault_set() would lose it.
 */
static void expect_codes_passed_on(const char *path, const char *text)
{
    for (const char *at = text; (at = strstr(at, "iso_fault_set(")); at++) {
        const size_t length = (size_t)(end_of_call(at) - at);
        char *call = strndup(at, length);
        assert_non_null(call);
        if (strstr(call, ".text") || strstr(call, "->text")) {
            fail_msg("%s loses the code of a fault: %s", path, call);
        }
        free(call);
    }
}

/* Notes the codes that a source names, except the list of codes and the table of remedies, which
 * name all codes and raise none. */
static int look_into(const char *path, const struct stat *status, int kind, struct FTW *walk)
{
    const char *base = path + walk->base, *ending = strrchr(base, '.');
    size_t size = 0;
    (void)status;
    if (kind != FTW_F || !ending || (strcmp(ending, ".c") != 0 && strcmp(ending, ".cc") != 0) ||
        strcmp(base, "fault_code.c") == 0 || strcmp(base, "remedy.c") == 0) {
        return 0;
    }
    char *bytes = scratch_read(path, &size), *text = strndup(bytes, size), word[64];
    assert_non_null(text);
    for (enum iso_fault_code code = ISO_FAULT_NONE; code < ISO_FAULT_CODES; code++) {
        spell(code, word);
        raised[code] |= has_word(text, word);
    }
    expect_codes_passed_on(path, text);
    free(text);
    free(bytes);
    return 0;
}

static void every_code_is_raised_by_the_product_and_passed_on(void **state)
{
    static const char *const rooms[] = {"core", "drivers", "firmware", "enroll"};
    char path[512];
    (void)state;
    for (size_t i = 0; i < sizeof rooms / sizeof *rooms; i++) {
        (void)snprintf(path, sizeof path, ISOTHERM_SOURCE_DIR "/%s", rooms[i]);
        assert_int_equal(nftw(path, look_into, 16, FTW_PHYS), 0);
    }
    for (enum iso_fault_code code = ISO_FAULT_NONE; code < ISO_FAULT_CODES; code++) {
        if (!raised[code]) {
            fail_msg("nothing raises %s", iso_fault_code_name(code));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_code_has_a_name_of_its_own),
        cmocka_unit_test(every_code_has_a_meaning_and_a_remedy),
        cmocka_unit_test(a_fault_carries_its_code),
        cmocka_unit_test(a_line_of_the_log_ends_with_the_code),
        cmocka_unit_test(every_code_is_raised_by_the_product_and_passed_on),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
