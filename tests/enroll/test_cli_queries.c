/* The commands that need no camera: list, remove, validity, rename, status and import, against a
 * scripted daemon. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "firmware/contract/contract.h"
#include "tests/enroll/rigs/cli.h"
#include "tests/support/scratch.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static void list_shows_everybody(void **state)
{
    const struct cli_result result = cli_run(&cli_two_people, "list");

    (void)state;
    cli_expect_exit(&result, 0);
    assert_non_null(strstr(result.out, "\nanna                     2026-11-21 08:00  -          "
                                       "       2026-12-30 23:59  2\n"));
    assert_non_null(strstr(result.out, "\nBo Ek                    2026-11-21 08:01  2026-11-21 "
                                       "22:26  -                 1\n"));
}

/* Chinese letters take two columns, and a combining accent takes none, so that the dates are in one
 * column. */
static void list_aligns_wide_letters(void **state)
{
    static const struct fake_person abroad[] = {
        {"\u5f20\u4f1f", 1795248000, 0, 0, 1},
        {"Jose\u0301", 1795248000, 0, 0, 1},
        {"Anna Margareta Wilhelmina Ek", 1795248000, 0, 0, 1},
    };
    const struct fake_script script = {.people = abroad, .n_people = COUNT(abroad)};
    const struct cli_result result = cli_run(&script, "list");

    (void)state;
    assert_non_null(strstr(result.out, "\n\u5f20\u4f1f                         2026-11-21"));
    assert_non_null(strstr(result.out, "\nJose\u0301                         2026-11-21"));
    assert_non_null(strstr(result.out, "\nAnna Margareta Wilhelmina Ek 2026-11-21"));
}

/* A gallery of an earlier version. The program prints the names in a form that a user can type
 * again. */
static void list_names_those_who_look_the_same(void **state)
{
    static const struct fake_person twins[] = {
        {"Ada", 1795248000, 0, 0, 1},       {"bob", 1795248000, 0, 0, 1},
        {"A\u200bda", 1795248000, 0, 0, 1}, {"O'Brien", 1795248000, 0, 0, 1},
        {"o'brien", 1795248000, 0, 0, 1},
    };
    const struct fake_script script = {.people = twins, .n_people = COUNT(twins)};
    const struct cli_result result = cli_run(&script, "list");

    (void)state;
    cli_expect_exit(&result, 0);
    assert_string_equal(
        result.err, "isotherm: $'Ada' and $'A\\u200Bda' look the same; give one of them another "
                    "name (isotherm rename)\n"
                    "isotherm: $'O\\'Brien' and $'o\\'brien' look the same; give one of them "
                    "another name (isotherm rename)\n");
}

static void one_person_is_no_people(void **state)
{
    const struct fake_script script = {.people = cli_two_people.people, .n_people = 1};
    const struct fake_person single = {"anna", 1795248000, 0, 0, 1};
    const struct fake_script one = {.people = &single, .n_people = 1};

    (void)state;
    assert_non_null(strstr(cli_run(&script, "doctor").out, " 1 person, 2 usable templates\n"));
    assert_non_null(strstr(cli_run(&one, "doctor").out, " 1 person, 1 usable template\n"));
}

static void list_of_nobody(void **state)
{
    const struct fake_script script = {0};

    (void)state;
    assert_string_equal(cli_run(&script, "list").out, "nobody is enrolled\n");
    const struct cli_result result = cli_run(&script, "list --json");
    json_t *document = cli_json(&result);
    assert_int_equal(json_array_size(json_object_get(document, "people")), 0);
    assert_true(json_is_array(json_object_get(document, "people")));
    json_decref(document);
}

static void list_as_json(void **state)
{
    const struct cli_result result = cli_run(&cli_two_people, "--json list");
    json_t *document = cli_json(&result), *person;

    (void)state;
    person = json_array_get(json_object_get(document, "people"), 1);
    assert_string_equal(json_string_value(json_object_get(person, "person")), "Bo Ek");
    assert_int_equal(json_integer_value(json_object_get(person, "enrolled")), 1795248060);
    assert_int_equal(json_integer_value(json_object_get(person, "valid_from")), 1795300000);
    assert_int_equal(json_integer_value(json_object_get(person, "valid_until")), 0);
    assert_int_equal(json_integer_value(json_object_get(person, "templates")), 1);
    json_decref(document);
}

static void remove_says_whom(void **state)
{
    (void)state;
    assert_string_equal(cli_run(&cli_two_people, "remove anna").out, "anna is removed.\n");
    const struct cli_result result = cli_run(&cli_two_people, "remove anna --json");
    json_t *document = cli_json(&result);
    assert_string_equal(json_string_value(json_object_get(document, "removed")), "anna");
    json_decref(document);
}

static void remove_of_a_stranger(void **state)
{
    struct cli_result result = cli_run(&cli_two_people, "remove carl --json");

    (void)state;
    cli_expect_error(&result, 3, "no-such-person");
    result = cli_run(&cli_two_people, "remove carl");
    assert_string_equal(result.err, "isotherm: carl: no such person\n");
    assert_string_equal(result.out, "");
}

static void validity_says_what_is_stored(void **state)
{
    struct cli_result result = cli_run(&cli_two_people, "validity ANNA --until 2026-12-30");

    (void)state;
    assert_int_equal(result.exit, 0);
    assert_string_equal(result.calls, "SetValidity ANNA valid-until=1798675199");
    assert_string_equal(result.out, "The door opens to anna until 2026-12-30 23:59.\n");
    result = cli_run(&cli_two_people,
                     "validity anna --from 2026-12-01Z --until @1798675199 --expired");
    assert_string_equal(result.calls, "SetValidity anna valid-from=1796083200 "
                                      "valid-until=1798675199 expired=1");
    result = cli_run(&cli_two_people, "validity anna --none");
    assert_string_equal(result.calls, "SetValidity anna valid-from=0 valid-until=0");
    result = cli_run(&cli_two_people, "validity anna --from none");
    assert_string_equal(result.calls, "SetValidity anna valid-from=0");
    result = cli_run(&cli_two_people, "validity \"Bo Ek\" --none --json");
    cli_expect_error(&result, 2, "usage"); /* no shell reads the line: these are two words */
    result = cli_run(&cli_two_people, "validity anna --none --json");
    json_t *document = cli_json(&result);
    assert_string_equal(json_string_value(json_object_get(document, "person")), "anna");
    assert_int_equal(json_integer_value(json_object_get(document, "valid_from")), 0);
    assert_int_equal(json_integer_value(json_object_get(document, "valid_until")), 1798675199);
    json_decref(document);
    result = cli_run(&cli_two_people, "validity zoe --none --json");
    cli_expect_error(&result, 3, "no-such-person");
}

static void rename_says_what_is_left_to_do(void **state)
{
    struct fake_script script = cli_two_people;
    struct cli_result result = cli_run(&script, "rename anna eve");

    (void)state;
    assert_int_equal(result.exit, 0);
    assert_string_equal(result.out, "anna is called eve now.\n");
    assert_string_equal(result.err, "");
    script.remark = "the file of card numbers has the old name";
    result = cli_run(&script, "rename anna eve");
    assert_string_equal(result.err, "isotherm: the file of card numbers has the old name\n");
    result = cli_run(&script, "rename anna eve --json");
    json_t *document = cli_json(&result);
    assert_string_equal(json_string_value(json_object_get(document, "renamed")), "anna");
    assert_string_equal(json_string_value(json_object_get(document, "person")), "eve");
    assert_string_equal(json_string_value(json_object_get(document, "remark")), script.remark);
    json_decref(document);
    result = cli_run(&cli_two_people, "rename zoe eve --json");
    cli_expect_error(&result, 3, "no-such-person");
}

static void status_keeps_names_and_types(void **state)
{
    const struct cli_result result = cli_run(&cli_two_people, "status --json");
    json_t *document = cli_json(&result);

    (void)state;
    assert_string_equal(json_string_value(json_object_get(document, "door-state")), "locked");
    assert_int_equal(json_integer_value(json_object_get(document, "people")), 2);
    assert_int_equal(json_integer_value(json_object_get(document, "frames")), 1099511627776);
    assert_true(json_real_value(json_object_get(document, "threshold")) == 1.25);
    json_decref(document);
}

/* The status has sections with plain names and units. The names of the bus are for programs. */
static void status_is_for_people(void **state)
{
    const struct cli_result result = cli_run(&cli_two_people, "status");

    (void)state;
    cli_expect_exit(&result, 0);
    assert_non_null(strstr(result.out, "\nDoor\n  state                  locked\n"));
    assert_non_null(strstr(result.out, "  running for            2 h 5 min\n"));
    assert_non_null(strstr(result.out, "  distance               612.4 mm\n"));
    assert_non_null(strstr(result.out, "  score needed           1.25\n"));
    assert_non_null(strstr(result.out, "  measured of the head   93 %\n"));
    static const char *const raw[] = {"door-state", "uptime-ms", "distance-mm", "00c0ffee"};
    for (size_t i = 0; i < COUNT(raw); i++) {
        assert_null(strstr(result.out, raw[i]));
    }
}

/* An object that is no file is refused before the daemon gets it, so that the program does not wait
 * for the writer of a FIFO. */
static void import_reads_files_alone(void **state)
{
    static const char *const said[] = {"is a FIFO, not a file", "is a symbolic link, not a file",
                                       "is a directory, not a file"};
    const char *paths[] = {scratch_path(*state, "fifo"), scratch_path(*state, "link"), *state};

    assert_int_equal(mkfifo(paths[0], 0600), 0);
    assert_int_equal(symlink("/dev/zero", paths[1]), 0);
    for (size_t i = 0; i < COUNT(paths); i++) {
        char words[256];
        (void)snprintf(words, sizeof words, "import %s", paths[i]);
        const struct cli_result result = cli_run(&cli_two_people, words);
        cli_expect_exit(&result, 4);
        assert_non_null(strstr(result.err, said[i]));
    }
}

/* With --replace the answer names no people who stay as they are. A file for an appliance needs no
 * passphrase. */
static void import_says_whether_people_were_replaced(void **state)
{
    static const char sealed[32] = ISO_CONTRACT_PEOPLE_MAGIC "\002";
    const struct fake_script script = {.n_people = 0};
    char words[512], path[256];

    (void)snprintf(path, sizeof path, "%s", scratch_path(*state, "people"));
    scratch_write(path, sealed, sizeof sealed);
    (void)snprintf(words, sizeof words, "import %s", path);
    assert_string_equal(cli_run(&script, words).out,
                        "2 people added, 0 were known and stay as they are.\n");
    (void)snprintf(words, sizeof words, "import --replace %s", path);
    assert_string_equal(cli_run(&script, words).out, "2 people added or replaced.\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(import_reads_files_alone, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(import_says_whether_people_were_replaced, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test(list_shows_everybody),
        cmocka_unit_test(list_aligns_wide_letters),
        cmocka_unit_test(list_names_those_who_look_the_same),
        cmocka_unit_test(one_person_is_no_people),
        cmocka_unit_test(list_of_nobody),
        cmocka_unit_test(list_as_json),
        cmocka_unit_test(remove_says_whom),
        cmocka_unit_test(remove_of_a_stranger),
        cmocka_unit_test(validity_says_what_is_stored),
        cmocka_unit_test(rename_says_what_is_left_to_do),
        cmocka_unit_test(status_keeps_names_and_types),
        cmocka_unit_test(status_is_for_people),
    };

    setenv("TZ", "UTC", 1); /* the programs print local time */
    return cli_find_bus() ? cmocka_run_group_tests(tests, NULL, cli_teardown) : TEST_SKIPPED;
}
