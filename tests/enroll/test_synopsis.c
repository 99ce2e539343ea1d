/* The SYNOPSIS of each manual has every command and option of the program, and no others. The
 * --help of a program prints them from the tables with which the program reads its options. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

#define MANUAL ISOTHERM_SOURCE_DIR "/enroll/man/"

enum { NAME_SIZE = 64, SYNOPSIS_SIZE = 32 * 1024 };

static const char isotherm[] = ISOTHERM_BINARY_DIR "/enroll/isotherm";
static const char isothermd[] = ISOTHERM_BINARY_DIR "/firmware/isothermd";
static const char screen[] = ISOTHERM_BINARY_DIR "/enroll/screen/isotherm-screen";
static const char web[] = ISOTHERM_BINARY_DIR "/enroll/web/isotherm-web";
static const char simulator[] = ISOTHERM_BINARY_DIR "/sim/isotherm-sim";

/* The SYNOPSIS of the present manual, and the part of it about one command. */
static char synopsis[SYNOPSIS_SIZE], part[SYNOPSIS_SIZE];

/* Returns the help of the program, or of a command ("", "eval", "shapes eval"), to be freed. */
static char *help_of(const char *program, const char *command)
{
    char words[NAME_SIZE];
    const char *argv[5] = {program};
    size_t argc = 1;
    struct run run;

    (void)snprintf(words, sizeof words, "%s", command);
    for (char *word = strtok(words, " "); word; word = strtok(NULL, " ")) {
        argv[argc++] = word;
    }
    argv[argc] = "--help";
    run_start(&run, argv);
    run_finish(&run);
    if (run.exit != 0) {
        fail_msg("%s %s --help: exit code %d: %s", program, command, run.exit, run.err);
    }
    char *text = strdup(run.out);
    run_free(&run);
    return text;
}

static void read_synopsis(const char *manual)
{
    size_t size;
    char *bytes = scratch_read(manual, &size), *text = strndup(bytes, size);
    const char *start = strstr(text, "\n.Sh SYNOPSIS\n");
    const char *end = strstr(text, "\n.Sh DESCRIPTION\n");

    assert_non_null(start);
    assert_non_null(end);
    (void)snprintf(synopsis, sizeof synopsis, "%.*s\n", (int)(end - start), start);
    free(bytes);
    free(text);
}

/* Whether the form of use that begins here belongs to the command. */
static bool is_of(const char *form, const char *command)
{
    const char *line = strchr(form + 1, '\n');
    const size_t length = strlen(command);

    if (!line || strncmp(line, "\n.Cm ", 5) != 0) {
        return length == 0;
    }
    const char *name = line + 5;
    const char *after = name + length;
    return length > 0 && strncmp(name, command, length) == 0 && strchr(" \n", *after) &&
           *after != '\0';
}

/* Collects all forms of use of the command ("": those without a command) in `part`. */
static void collect_forms(const char *command)
{
    size_t length = 0;

    part[0] = '\0';
    for (const char *form = strstr(synopsis, "\n.Nm "); form;) {
        const char *next = strstr(form + 1, "\n.Nm ");
        const size_t size = next ? (size_t)(next - form) : strlen(form);
        if (is_of(form, command)) {
            memcpy(part + length, form, size);
            length += size;
            part[length++] = '\n';
            part[length] = '\0';
        }
        form = next;
    }
}

/* Whether a text has an option with `before` in front of it, and a blank or a line end after it. */
static bool has_option(const char *text, const char *before, const char *name)
{
    char item[2 * NAME_SIZE];

    (void)snprintf(item, sizeof item, "%s%s", before, name);
    for (const char *at = text; (at = strstr(at, item)); at++) {
        if (strchr(" \n", at[strlen(item)])) {
            return true;
        }
    }
    return false;
}

/* Reads the name that begins here, up to a blank or a line end. */
static const char *name_at(const char *at)
{
    static char name[NAME_SIZE];

    (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(at, " \n"), at);
    return name;
}

/* Every option of `help`, except those in `common`, is in the forms of the command. Every option in
 * the forms is one of `help`. Returns how many options there are. */
static size_t compare_pages(const char *command, const char *help, const char *common)
{
    size_t count = 0;

    collect_forms(command);
    if (!part[0]) {
        fail_msg("the SYNOPSIS does not have '%s'", command);
    }
    for (const char *at = help; (at = strstr(at, "\n  --")); at++) {
        const char *name = name_at(at + strlen("\n  --"));
        if (!(common && has_option(common, "\n  --", name)) && !has_option(part, "Fl Fl ", name)) {
            fail_msg("the SYNOPSIS of '%s' does not have --%s", command, name);
        }
        count++;
    }
    for (const char *at = part; (at = strstr(at, "Fl Fl ")); at++) {
        const char *name = name_at(at + strlen("Fl Fl "));
        if (strcmp(name, "help") != 0 && strcmp(name, "version") != 0 &&
            !has_option(help, "\n  --", name)) {
            fail_msg("the SYNOPSIS of '%s' has --%s, which the program does not have", command,
                     name);
        }
    }
    return count;
}

/* Calls `look` for every command of a help, "  name ..." below "Commands:". Returns the sum of its
 * results. */
static size_t for_each_command(const char *program, const char *common,
                               size_t (*look)(const char *program, const char *command,
                                              const char *common))
{
    char command[NAME_SIZE];
    size_t count = 0;
    const char *at = strstr(common, "\nCommands:\n");

    assert_non_null(at);
    for (at += strlen("\nCommands:"); strncmp(at, "\n  ", 3) == 0; at = strchr(at + 1, '\n')) {
        (void)snprintf(command, sizeof command, "%s", name_at(at + 3));
        count += look(program, command, common);
    }
    return count;
}

static size_t look_at_command(const char *program, const char *command, const char *common)
{
    char *help = help_of(program, command);
    const size_t count = compare_pages(command, help, common);

    free(help);
    return count;
}

static void the_synopsis_of_isotherm_is_complete(void **state)
{
    char *common = help_of(isotherm, "");

    (void)state;
    read_synopsis(MANUAL "isotherm.1");
    assert_int_equal(compare_pages("", common, NULL), 5);
    assert_true(for_each_command(isotherm, common, look_at_command) > 80);
    free(common);
}

/* Compares the pages of one command, or of each command of a group: "Usage: isotherm-sim train
 * head|cohort|metric [OPTION...]". Returns how many options there are. */
static size_t look_at_simulator(const char *program, const char *command, const char *common)
{
    char *help = help_of(program, command), usage[NAME_SIZE], own[2 * NAME_SIZE];
    size_t count = 0;

    const int length = snprintf(usage, sizeof usage, "Usage: isotherm-sim %s ", command);
    assert_in_range(length, 1, sizeof usage - 1);
    assert_int_equal(strncmp(help, usage, strlen(usage)), 0);
    char *words = help + strlen(usage);
    words[strcspn(words, " \n")] = '\0';
    if (words[0] == '-') {
        free(help);
        return look_at_command(program, command, common);
    }
    for (char *rest = NULL, *word = strtok_r(words, "|", &rest); word;
         word = strtok_r(NULL, "|", &rest)) {
        (void)snprintf(own, sizeof own, "%s %s", command, word);
        count += look_at_command(program, own, common);
    }
    free(help);
    return count;
}

static void the_synopsis_of_the_simulator_is_complete(void **state)
{
    char *common = help_of(simulator, "");

    (void)state;
    read_synopsis(MANUAL "isotherm-sim.1");
    assert_true(for_each_command(simulator, common, look_at_simulator) > 130);
    free(common);
}

static void the_synopsis_of_the_daemon_is_complete(void **state)
{
    char *help = help_of(isothermd, "");

    (void)state;
    read_synopsis(MANUAL "isothermd.8");
    assert_true(compare_pages("", help, NULL) >= 8);
    free(help);
}

static void the_synopsis_of_the_screen_is_complete(void **state)
{
    char *help = help_of(screen, "");

    (void)state;
    read_synopsis(MANUAL "isotherm-screen.1");
    assert_true(compare_pages("", help, NULL) >= 12);
    free(help);
}

static void the_synopsis_of_the_web_server_is_complete(void **state)
{
    char *help = help_of(web, "");

    (void)state;
    read_synopsis(MANUAL "isotherm-web.8");
    assert_true(compare_pages("", help, NULL) >= 4);
    free(help);
}

/* The manual names the path of the configuration in the section where readers look for it. */
static void the_manual_of_the_configuration_says_where_it_lies(void **state)
{
    size_t size;
    char *bytes = scratch_read(MANUAL "isotherm.conf.5", &size), *text = strndup(bytes, size);
    const char *files = strstr(text, "\n.Sh FILES\n");

    (void)state;
    assert_non_null(files);
    assert_non_null(strstr(files, "\n.It Pa /etc/isotherm/isotherm.conf\n"));
    free(bytes);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_synopsis_of_isotherm_is_complete),
        cmocka_unit_test(the_synopsis_of_the_simulator_is_complete),
        cmocka_unit_test(the_synopsis_of_the_daemon_is_complete),
        cmocka_unit_test(the_synopsis_of_the_screen_is_complete),
        cmocka_unit_test(the_synopsis_of_the_web_server_is_complete),
        cmocka_unit_test(the_manual_of_the_configuration_says_where_it_lies),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
