/* The simulator's output on a terminal: progress, if main() enables it and for one task at a time,
 * and verdicts in colour. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "sim/base/progress.h"
#include "sim/door/visit_report.h"
#include "sim/lab/match/parallel.h"
#include "tests/support/devices/pseudo_terminal.h"

static struct pseudo_terminal pseudo;
static char text[65536];

static int do_nothing(void *context, int worker, size_t job)
{
    (void)context, (void)worker, (void)job;
    return 0;
}

static const char *what_was_shown(void)
{
    pseudo_terminal_read(&pseudo, text, sizeof text);
    return text;
}

static void nothing_is_shown_unless_it_is_asked_for(void **state)
{
    (void)state;
    assert_false(sim_progress_begin("work", 3));
    sim_progress_step(1);
    sim_progress_pause();
    sim_progress_resume();
    sim_progress_end(false);
}

static void jobs_are_counted(void **state)
{
    (void)state;
    pseudo_terminal_open(&pseudo, 80);
    sim_progress_to(pseudo.slave);
    assert_int_equal(sim_parallel(2, "counting sheep", 5, do_nothing, NULL), 0);
    assert_non_null(strstr(what_was_shown(), "\r\033[Kcounting sheep  ["));
}

/* A task within a counted task is not shown, and does not count for it. */
static void one_thing_at_a_time_is_shown(void **state)
{
    (void)state;
    assert_true(sim_progress_begin("rendering", 4));
    sim_progress_step(1);
    assert_int_equal(sim_parallel(2, "counting sheep", 50, do_nothing, NULL), 0);
    sim_progress_pause();
    (void)what_was_shown();
    sim_progress_resume();
    assert_non_null(strstr(what_was_shown(), "rendering  [#######"));
    assert_non_null(strstr(text, " 25 %"));
    assert_null(strstr(text, "sheep"));
    sim_progress_end(true);
    assert_true(sim_progress_begin("the next", 4));
    sim_progress_end(true);
    sim_progress_to(NULL);
    pseudo_terminal_close(&pseudo);
}

/* The output names the visitor, and has the verdict in its colour. */
static void verdicts_have_colours(void **state)
{
    const struct sim_corpus_row row = {
        .subject = "x01", .role = SIM_ROLE_IMPOSTOR, .note = "alone"};
    struct sim_visit visit = {.row = &row, .verdict = {.given = true, .frames = 3}};

    (void)state;
    pseudo_terminal_open(&pseudo, 120);
    (void)setenv("TERM", "xterm", 1);
    (void)unsetenv("NO_COLOR");
    sim_visit_print(&visit, pseudo.slave);
    assert_non_null(strstr(what_was_shown(), " alone      \033[31mdeny   \033[0m -  "));
    visit.verdict.allow = true;
    sim_visit_print(&visit, pseudo.slave);
    assert_non_null(strstr(what_was_shown(), "\033[32mallow  \033[0m"));
    (void)setenv("NO_COLOR", "1", 1);
    sim_visit_print(&visit, pseudo.slave);
    assert_null(strchr(what_was_shown(), '\033'));
    pseudo_terminal_close(&pseudo);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_shown_unless_it_is_asked_for),
        cmocka_unit_test(jobs_are_counted),
        cmocka_unit_test(one_thing_at_a_time_is_shown),
        cmocka_unit_test(verdicts_have_colours),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
