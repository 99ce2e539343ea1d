/* The functions that all programs use on a terminal and elsewhere: columns, words, colours,
 * progress. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "drivers/terminal/columns.h"
#include "drivers/terminal/progress.h"
#include "drivers/terminal/terminal.h"
#include "drivers/terminal/words.h"
#include "tests/support/devices/pseudo_terminal.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const int64_t second_ns = 1000000000;

/* A clock that stands still until the test changes it. */
static int64_t told_ns;

static int64_t tell_ns(void *context)
{
    (void)context;
    return told_ns;
}

static const struct iso_clock clock_of_test = {tell_ns, NULL};

static void letters_take_the_columns_of_a_terminal(void **state)
{
    static const struct {
        const char *text;
        size_t columns;
    } cases[] = {
        {"", 0},
        {"anna", 4},
        {"Jos\u00e9", 4},
        {"Jose\u0301", 4},               /* e and a combining accent */
        {"\u5f20\u4f1f", 4},             /* two Chinese characters */
        {"\uae40\ubbfc\uc900", 6},       /* three Korean characters */
        {"\u0623\u062d\u0645\u062f", 4}, /* Arabic */
        {"a\033[31mb", 7},               /* an escape is a '?' */
        {"\xff", 1},
        {"a\xe5\xbc", 3}, /* cut within a character */
    };

    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        if (iso_columns_of(cases[i].text) != cases[i].columns) {
            fail_msg("case %zu takes %zu columns, not %zu", i, iso_columns_of(cases[i].text),
                     cases[i].columns);
        }
    }
}

static void texts_are_padded_to_columns(void **state)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);

    (void)state;
    iso_columns_print(out, "\u5f20\u4f1f", 6);
    fputc('|', out);
    iso_columns_print(out, "anna", 3);
    fputc('|', out);
    iso_columns_print(out, "a\033[31m", 0);
    fclose(out);
    assert_string_equal(text, "\u5f20\u4f1f  |anna|a?[31m");
    free(text);
}

static void durations_have_two_units_at_most(void **state)
{
    static const struct {
        int64_t seconds;
        const char *text;
    } cases[] = {{-5, "0 s"},        {0, "0 s"},        {59, "59 s"},        {60, "1 min"},
                 {125, "2 min 5 s"}, {3600, "1 h"},     {3661, "1 h 1 min"}, {86399, "23 h 59 min"},
                 {90000, "1 d 1 h"}, {86400 * 9, "9 d"}};
    char text[ISO_DURATION_SIZE];

    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        iso_duration_text(cases[i].seconds, text);
        assert_string_equal(text, cases[i].text);
    }
}

static const char *next_word(size_t index, const void *context)
{
    static const char *const words[] = {"enroll",   "identify", "list", "log",
                                        "lockdown", "lockout",  "key",  NULL};

    (void)context;
    return words[index];
}

static void the_word_that_was_meant_is_found(void **state)
{
    static const struct {
        const char *typed, *meant;
    } cases[] = {
        {"enrol", "enroll"},
        {"enrlol", "enroll"},
        {"lisst", "list"},
        {"identfy", "identify"},
        {"lgo", "log"},
        {"lockotu", "lockout"},
        {"ident", "identify"},
        {"kye", "key"},
        {"lockd", "lockdown"},
        {"dance", NULL},
        {"", NULL},
        {"x", NULL},
        {"abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuvwxyz", NULL},
    };

    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        const char *found = iso_words_nearest(cases[i].typed, next_word, NULL);
        if ((found == NULL) != (cases[i].meant == NULL) ||
            (found && strcmp(found, cases[i].meant) != 0)) {
            fail_msg("'%s' is taken for '%s'", cases[i].typed, found ? found : "nothing");
        }
    }
}

static void one_is_singular(void **state)
{
    (void)state;
    assert_string_equal(iso_plural(1, "person", "people"), "person");
    assert_string_equal(iso_plural(0, "person", "people"), "people");
    assert_string_equal(iso_plural(2, "person", "people"), "people");
}

static void colours_need_a_terminal_that_wants_them(void **state)
{
    struct pseudo_terminal pseudo;
    FILE *file = tmpfile();

    (void)state;
    pseudo_terminal_open(&pseudo, 132);
    setenv("TERM", "xterm", 1);
    unsetenv("NO_COLOR");
    struct iso_terminal terminal = iso_terminal_of(pseudo.slave);
    assert_true(terminal.is_terminal && terminal.colour);
    assert_int_equal(terminal.columns, 132);
    assert_string_equal(iso_terminal_paint(&terminal, ISO_PAINT_BAD), "\033[31m");
    setenv("NO_COLOR", "", 1); /* an empty value counts as unset: no-color.org */
    assert_true(iso_terminal_of(pseudo.slave).colour);
    setenv("NO_COLOR", "1", 1);
    terminal = iso_terminal_of(pseudo.slave);
    assert_true(terminal.is_terminal);
    assert_false(terminal.colour);
    assert_string_equal(iso_terminal_paint(&terminal, ISO_PAINT_BAD), "");
    unsetenv("NO_COLOR");
    setenv("TERM", "dumb", 1);
    assert_false(iso_terminal_of(pseudo.slave).colour);
    setenv("TERM", "xterm", 1);
    terminal = iso_terminal_of(file);
    assert_false(terminal.is_terminal || terminal.colour);
    assert_int_equal(terminal.columns, 80);
    fclose(file);
    pseudo_terminal_close(&pseudo);
}

static void a_bar_says_how_far_and_how_long(void **state)
{
    struct iso_progress_view view = {"rendering frames", 0, 40, 0};
    char text[256];

    (void)state;
    iso_progress_bar(&view, 60, text, sizeof text);
    assert_string_equal(text, "rendering frames  [..............................]    0 %");
    view.done = 10;
    view.elapsed_ns = 20 * second_ns;
    iso_progress_bar(&view, 60, text, sizeof text);
    assert_string_equal(text, "rendering frames  [#####...............]   25 %, 1 min left");
    iso_progress_bar(&view, 20, text, sizeof text); /* there is no space for a bar */
    assert_string_equal(text, " 25 %, 1 min left");
    iso_progress_line(&view, text, sizeof text);
    assert_string_equal(text, "rendering frames: 10 of 40, 1 min left");
    view.done = 41; /* more than the expected total */
    iso_progress_bar(&view, 60, text, sizeof text);
    assert_string_equal(text, "rendering frames  [##############################]  100 %");
}

static void progress_without_a_known_end_shows_the_time(void **state)
{
    const struct iso_progress_view view = {"verifying the log", 0, 0, 3 * second_ns};
    char text[256];

    (void)state;
    iso_progress_bar(&view, 40, text, sizeof text);
    assert_string_equal(text, "verifying the log  [...#.........]  3 s");
    iso_progress_line(&view, text, sizeof text);
    assert_string_equal(text, "verifying the log: 3 s so far");
}

static void a_terminal_gets_one_line_that_goes_again(void **state)
{
    struct pseudo_terminal pseudo;
    char text[1024];

    (void)state;
    pseudo_terminal_open(&pseudo, 50);
    told_ns = 5 * second_ns;
    struct iso_progress *progress = iso_progress_start(pseudo.slave, "p", "work", 4,
                                                       &clock_of_test);
    assert_non_null(progress);
    pseudo_terminal_read(&pseudo, text, sizeof text);
    assert_string_equal(text, "\r\033[Kwork  [..............................]    0 %");
    iso_progress_step(progress, 1);
    told_ns += 2 * second_ns;
    iso_progress_tick(progress);
    pseudo_terminal_read(&pseudo, text, sizeof text);
    assert_string_equal(text, "\r\033[Kwork  [######..................]   25 %, 6 s left");
    iso_progress_pause(progress);
    fputs("a result\n", pseudo.slave);
    pseudo_terminal_read(&pseudo, text, sizeof text);
    assert_string_equal(text, "\r\033[Ka result\r\n");
    iso_progress_resume(progress);
    pseudo_terminal_read(&pseudo, text, sizeof text);
    assert_non_null(strstr(text, "25 %"));
    iso_progress_end(progress);
    pseudo_terminal_read(&pseudo, text, sizeof text);
    assert_string_equal(text, "\r\033[K");
    pseudo_terminal_close(&pseudo);
}

static void a_pipe_gets_plain_lines_now_and_then(void **state)
{
    char *text = NULL;
    size_t size;
    FILE *out = tmpfile(), *copy = open_memstream(&text, &size);
    struct iso_progress *progress;
    int letter;

    (void)state;
    told_ns = 0;
    progress = iso_progress_start(out, "p", "work", 100, &clock_of_test);
    for (int i = 0; i < 150; i++) { /* a tenth of a second for each */
        told_ns += second_ns / 10;
        iso_progress_set(progress, (uint64_t)i / 2, 100);
        iso_progress_tick(progress);
    }
    iso_progress_end(progress);
    rewind(out);
    while ((letter = fgetc(out)) != EOF) {
        fputc(letter, copy);
    }
    fclose(out);
    fclose(copy);
    assert_string_equal(text, "p: work: 9 of 100, 20 s left\n"
                              "p: work: 59 of 100, 8 s left\n"
                              "p: work: ended after 15 s\n");
    free(text);
}

static void quick_work_prints_nothing_to_a_pipe(void **state)
{
    FILE *out = tmpfile();
    struct iso_progress *progress;

    (void)state;
    told_ns = 0;
    progress = iso_progress_start(out, "p", "work", 3, &clock_of_test);
    told_ns = 2 * second_ns - 1;
    iso_progress_tick(progress);
    iso_progress_end(progress);
    assert_int_equal(ftell(out), 0);
    fclose(out);
}

/* With the system's clock a thread draws the progress. It ends together with the progress. */
static void the_thread_of_a_progress_ends(void **state)
{
    struct pseudo_terminal pseudo;
    char text[4096];

    (void)state;
    pseudo_terminal_open(&pseudo, 50);
    struct iso_progress *progress = iso_progress_start(pseudo.slave, "p", "work", 2, NULL);
    assert_non_null(progress);
    iso_progress_step(progress, 2);
    iso_progress_pause(progress);
    iso_progress_resume(progress);
    iso_progress_end(progress);
    pseudo_terminal_read(&pseudo, text, sizeof text);
    assert_non_null(strstr(text, "100 %"));
    pseudo_terminal_close(&pseudo);
    iso_progress_step(NULL, 1);
    iso_progress_set(NULL, 1, 1);
    iso_progress_pause(NULL);
    iso_progress_resume(NULL);
    iso_progress_tick(NULL);
    iso_progress_end(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(letters_take_the_columns_of_a_terminal),
        cmocka_unit_test(texts_are_padded_to_columns),
        cmocka_unit_test(durations_have_two_units_at_most),
        cmocka_unit_test(the_word_that_was_meant_is_found),
        cmocka_unit_test(one_is_singular),
        cmocka_unit_test(colours_need_a_terminal_that_wants_them),
        cmocka_unit_test(a_bar_says_how_far_and_how_long),
        cmocka_unit_test(progress_without_a_known_end_shows_the_time),
        cmocka_unit_test(a_terminal_gets_one_line_that_goes_again),
        cmocka_unit_test(a_pipe_gets_plain_lines_now_and_then),
        cmocka_unit_test(quick_work_prints_nothing_to_a_pipe),
        cmocka_unit_test(the_thread_of_a_progress_ends),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
