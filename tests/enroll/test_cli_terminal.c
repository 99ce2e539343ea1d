/* isotherm's output that is only for terminals: colours and progress. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/enroll/rigs/cli.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const struct fake_person people[] = {{"anna", 1795248000, 0, 0, 2}};
static const struct fake_script healthy = {.people = people, .n_people = 1, .n_records = 2};

/* Runs the words on a terminal. The text has to be in the output, or (absent) must not be. */
static void expect(const struct fake_script *script, const char *words, const char *environment,
                   const char *text, bool absent)
{
    const struct cli_result result = cli_run_on_terminal(script, words, environment);
    char *out = (char *)(uintptr_t)result.out;

    if ((strstr(out, text) == NULL) != absent) {
        fail_msg("%s: '%s' is %s in: %s", words, text, absent ? "" : "not", out);
    }
    free(out);
}

static void findings_have_colours(void **state)
{
    const struct fake_script lost = {.sensor_state = "lost"};

    (void)state;
    expect(&healthy, "doctor", NULL, "\033[32mok      \033[0m bus ", false);
    expect(&lost, "doctor", NULL, "\033[31mfault   \033[0m sensor ", false);
    expect(&lost, "doctor", NULL, "\033[33mwarning \033[0m gallery ", false);
    expect(&lost, "doctor", "NO_COLOR=1", "\033", true);
    expect(&lost, "doctor", "TERM=dumb", "\033", true);
}

static void verdicts_have_colours(void **state)
{
    static const struct fake_status yes = {"identify-match", true, 0, 0, 3.25, "anna", 3.0};
    static const struct fake_status no = {"identify-no-match", true, 0, 0, 1.25, "", 3.0};
    const struct fake_script match = {.statuses = &yes, .n_statuses = 1};
    const struct fake_script stranger = {.statuses = &no, .n_statuses = 1};

    (void)state;
    expect(&match, "identify", NULL, "\033[32manna\033[0m (score 3.25", false);
    expect(&stranger, "identify", NULL, "\033[31mnot known\033[0m (best", false);
    expect(&match, "identify", "NO_COLOR=1", "\033[3", true); /* the progress has \033[K */
    expect(&match, "identify", "NO_COLOR=1", "\033[0m", true);
    expect(&healthy, "log", NULL, "visit \033[32mverdict=allow\033[0m person=anna", false);
}

static void an_enrolment_shows_its_stages(void **state)
{
    static const struct fake_status statuses[] = {
        {"enroll-retry-too-far", false, 0, 4, 0, NULL, 0},
        {"enroll-stage-passed", false, 1, 4, 0.9, NULL, 0},
        {"enroll-stage-passed", false, 2, 4, 0.9, NULL, 0},
        {"enroll-completed", true, 4, 4, 0.9, NULL, 0},
    };
    const struct fake_script script = {.statuses = statuses, .n_statuses = COUNT(statuses)};

    (void)state;
    expect(&script, "enroll anna", NULL, "\r\033[Kenrolling anna  [", false);
    expect(&script, "enroll anna", NULL, "]   25 %", false);
    expect(&script, "enroll anna", NULL, "]   50 %", false);
    expect(&script, "enroll anna", NULL, "\r\033[Kstage 2/4 done (quality 0.90)\r\n", false);
    expect(&script, "enroll anna", NULL, "\033[32manna is enrolled.\033[0m", false);
}

static void a_recognition_shows_that_it_goes_on(void **state)
{
    static const struct fake_status statuses[] = {
        {"identify-retry-too-far", false, 0, 0, 0, NULL, 0},
        {"identify-match", true, 0, 0, 3.25, "anna", 3.0},
    };
    static const struct fake_status verified = {"verify-match", true, 0, 0, 3.25, "anna", 3.0};
    const struct fake_script script = {.statuses = statuses, .n_statuses = COUNT(statuses)};
    const struct fake_script verifying = {.statuses = &verified, .n_statuses = 1};

    (void)state;
    expect(&script, "identify", NULL, "\r\033[Klooking for a face", false);
    expect(&script, "identify", NULL, "\r\033[K  come closer\r\n", false);
    expect(&verifying, "verify anna", NULL, "\r\033[Klooking for a face", false);
}

static void reading_the_log_shows_how_far_it_is(void **state)
{
    const struct fake_script script = {.n_records = 3};

    (void)state;
    expect(&script, "log --person carl", NULL, "\r\033[Kreading the log  [", false);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(findings_have_colours),
        cmocka_unit_test(verdicts_have_colours),
        cmocka_unit_test(an_enrolment_shows_its_stages),
        cmocka_unit_test(a_recognition_shows_that_it_goes_on),
        cmocka_unit_test(reading_the_log_shows_how_far_it_is),
    };

    setenv("TZ", "UTC", 1);
    return cli_find_bus() ? cmocka_run_group_tests(tests, NULL, cli_teardown) : TEST_SKIPPED;
}
