/* isotherm's output about the progress of a long call. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/contract/contract.h"
#include "tests/enroll/rigs/cli.h"
#include "tests/support/scratch.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* The remaining time is not printed before a second has passed. */
static const struct fake_progress half = {50, 100, 0};
static const struct fake_script half_way = {.progress = &half, .n_progress = 1, .answer_ms = 2500};

static void expect(const struct cli_result *result, const char *text)
{
    if (!strstr(result->out, text)) {
        fail_msg("%s: '%s' is not in: %s", result->what, text, result->out);
    }
}

/* The words on a terminal: the action, the progress, the remaining time, and the answer. */
static void expect_bar(const char *words, const char *what, const char *answer)
{
    char bar[64];
    const struct cli_result result = cli_run_on_terminal(&half_way, words, NULL);

    (void)snprintf(bar, sizeof bar, "\r\033[K%s  [", what);
    cli_expect_exit(&result, 0);
    expect(&result, bar);
    expect(&result, "]   50 %, ");
    expect(&result, " s left");
    expect(&result, answer);
    free((char *)(uintptr_t)result.out);
}

static void a_terminal_shows_share_and_time_left(void **state)
{
    char file[32] = ISO_CONTRACT_PEOPLE_MAGIC, words[256];
    const char *path = scratch_path(*state, "people");

    expect_bar("log verify", "verifying the log", "records 1 to 100 are sound");
    expect_bar("key rotate", "sealing gallery and log anew", "sealed with new keys.");
    (void)snprintf(words, sizeof words, "export %s --address aa", path);
    expect_bar(words, "exporting people", "holds 2 people, sealed.");
    file[ISO_CONTRACT_PEOPLE_LOCK_AT] = ISO_CONTRACT_PEOPLE_APPLIANCE;
    scratch_write(path, file, sizeof file);
    (void)snprintf(words, sizeof words, "import %s --address aa", path);
    expect_bar(words, "importing people", "2 people added");
}

/* The daemon takes longer than the 10 s that other calls may take. */
static void a_pipe_gets_plain_lines(void **state)
{
    static const struct fake_progress slow[] = {{20, 100, 1500}, {60, 100, 4500}};
    const struct fake_script script = {
        .progress = slow, .n_progress = COUNT(slow), .answer_ms = 7500};
    const struct cli_result result = cli_run(&script, "log verify");

    (void)state;
    cli_expect_exit(&result, 0);
    assert_non_null(strstr(result.out, "records 1 to 100 are sound"));
    assert_non_null(strstr(result.err, " s left\n"));
    assert_null(strchr(result.err, '\033'));
    assert_null(strchr(result.err, '\r'));
    assert_non_null(strstr(result.err, "isotherm: verifying the log: 20 of 100, "));
    assert_non_null(strstr(result.err, "isotherm: verifying the log: 60 of 100, "));
    assert_non_null(strstr(result.err, "isotherm: verifying the log: ended after 1"));
}

/* All records are sealed, and the daemon writes them to the disk. This takes longer than other
 * calls may take. */
static void a_rotation_may_be_silent_for_more_than_ten_seconds(void **state)
{
    static const struct fake_progress sealed = {100, 100, 0};
    const struct fake_script script = {.progress = &sealed, .n_progress = 1, .answer_ms = 10500};
    const struct cli_result result = cli_run(&script, "key rotate");

    (void)state;
    cli_expect_exit(&result, 0);
    expect(&result, "sealed with new keys.");
}

/* Impossible numbers do no harm. */
static void nonsense_is_no_fault(void **state)
{
    static const struct fake_progress wrong[] = {{9, 0, 0}, {101, 100, 0}, {UINT64_MAX, 1, 300}};
    const struct fake_script script = {
        .progress = wrong, .n_progress = COUNT(wrong), .answer_ms = 300};
    const struct cli_result result = cli_run_on_terminal(&script, "log verify", NULL);

    (void)state;
    cli_expect_exit(&result, 0);
    expect(&result, "]  100 %");
    expect(&result, "records 1 to 100 are sound");
    free((char *)(uintptr_t)result.out);
}

static void an_older_daemon_says_nothing(void **state)
{
    const struct fake_script script = {.answer_ms = 1500};
    const struct cli_result result = cli_run_on_terminal(&script, "key rotate", NULL);

    (void)state;
    cli_expect_exit(&result, 0);
    expect(&result, "\r\033[Ksealing gallery and log anew  [#");
    assert_null(strchr(result.out, '%'));
    expect(&result, "sealed with new keys.");
    free((char *)(uintptr_t)result.out);
}

static void a_fault_comes_through(void **state)
{
    const struct fake_script script = {.fail_method = "VerifyLog",
                                       .fail_error = ISO_CONTRACT_ERROR_INTERNAL};
    const struct cli_result result = cli_run(&script, "--json log verify");

    (void)state;
    cli_expect_error(&result, 4, "internal");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_terminal_shows_share_and_time_left, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test(a_pipe_gets_plain_lines),
        cmocka_unit_test(a_rotation_may_be_silent_for_more_than_ten_seconds),
        cmocka_unit_test(nonsense_is_no_fault),
        cmocka_unit_test(an_older_daemon_says_nothing),
        cmocka_unit_test(a_fault_comes_through),
    };

    return cli_find_bus() ? cmocka_run_group_tests(tests, NULL, cli_teardown) : TEST_SKIPPED;
}
