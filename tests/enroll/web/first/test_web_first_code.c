/* The code for the first account that the server makes itself: it waits while there is no account,
 * makes room for one of root, ends an hour after the start, and the server notices that a factory
 * reset has removed the accounts. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include <sodium.h>

#include "enroll/web/account/account.h"
#include "enroll/web/account/setup_code.h"
#include "enroll/web/first_code.h"
#include "tests/support/scratch.h"

static const char password[] = "correct horse battery";

static struct {
    sd_event *event;
    struct web_accounts *accounts;
    struct web_first_code *first;
    char accounts_path[256], code_path[256], shown_path[256];
} rig;

static int64_t now_s, up_s;

static int64_t up(void)
{
    return up_s;
}

static int64_t now(void)
{
    return now_s;
}

static void start(bool makes_codes)
{
    const struct web_first_code_setup setup = {.event = rig.event,
                                               .accounts = rig.accounts,
                                               .accounts_path = rig.accounts_path,
                                               .code_path = rig.code_path,
                                               .makes_codes = makes_codes,
                                               .now_s = now,
                                               .up_s = up,
                                               .every_us = 1000};

    assert_int_equal(web_first_code_new(&setup, &rig.first), 0);
}

static int setup(void **state)
{
    struct iso_fault fault = {.text = ""};

    assert_int_equal(scratch_setup(state), 0);
    assert_true(sodium_init() >= 0);
    now_s = 1000000;
    up_s = 100;
    (void)snprintf(rig.accounts_path, sizeof rig.accounts_path, "%s/accounts.json",
                   (const char *)*state);
    (void)snprintf(rig.code_path, sizeof rig.code_path, "%s/setup.code", (const char *)*state);
    (void)snprintf(rig.shown_path, sizeof rig.shown_path, "%s/setup-code", (const char *)*state);
    assert_int_equal(setenv("RUNTIME_DIRECTORY", *state, 1), 0);
    assert_int_equal(sd_event_new(&rig.event), 0);
    assert_int_equal(web_accounts_open(rig.accounts_path, &rig.accounts, &fault), 0);
    return 0;
}

static int teardown(void **state)
{
    web_first_code_free(rig.first);
    rig.first = NULL;
    web_accounts_close(rig.accounts);
    sd_event_unref(rig.event);
    return scratch_teardown(state);
}

/* Lets the timer look some more times. Returns what the loop has ended with; 1: it goes on. */
static int look(void)
{
    for (int i = 0; i < 5; i++) {
        assert_true(sd_event_run(rig.event, 1000000) >= 0);
        if (sd_event_get_state(rig.event) == SD_EVENT_FINISHED) {
            int code = 0;
            assert_int_equal(sd_event_get_exit_code(rig.event, &code), 0);
            return code;
        }
    }
    return 1;
}

/* The code that the screen shows, in a new text; NULL: none. */
static char *shown(void)
{
    if (!scratch_exists(rig.shown_path)) {
        return NULL;
    }
    char *text = scratch_read_text(rig.shown_path);
    text[strcspn(text, "\n")] = '\0';
    return text;
}

static void expect_shown_and_valid(void)
{
    char *code = shown();

    assert_non_null(code);
    assert_int_equal(strlen(code), WEB_SETUP_CODE_SIZE - 1);
    assert_true(web_setup_code_is(rig.code_path, now_s, code));
    free(code);
}

static void a_code_waits_until_there_is_an_account(void **state)
{
    struct iso_fault fault = {.text = ""};
    (void)state;

    start(true);
    assert_int_equal(look(), 1);
    expect_shown_and_valid();
    char *before = shown();
    assert_int_equal(look(), 1); /* it stays the same */
    char *after = shown();
    assert_string_equal(before, after);
    assert_int_equal(web_setup_code_use(rig.code_path, now_s, before, &fault), 0);
    assert_int_equal(
        web_accounts_add(rig.accounts, "ada", password, WEB_ROLE_ADMINISTRATOR, &fault), 0);
    assert_int_equal(look(), 1);
    assert_null(shown());
    assert_false(web_setup_code_waits(rig.code_path, now_s));
    free(before);
    free(after);
}

static void a_code_that_has_ended_is_followed_by_the_next(void **state)
{
    (void)state;
    start(true);
    assert_int_equal(look(), 1);
    char *before = shown();
    now_s += WEB_SETUP_CODE_VALID_S + 1;
    assert_int_equal(look(), 1);
    expect_shown_and_valid();
    assert_false(web_setup_code_is(rig.code_path, now_s, before));
    free(before);
}

/* Also if the clock is set meanwhile. */
static void after_an_hour_there_is_no_code_until_the_next_start(void **state)
{
    (void)state;
    start(true);
    assert_int_equal(look(), 1);
    char *before = shown();
    up_s += WEB_FIRST_CODE_HELD_S - 1;
    now_s += 1000000000;
    assert_int_equal(look(), 1);
    expect_shown_and_valid();
    now_s -= 1000000000;
    up_s++;
    assert_int_equal(look(), 1);
    assert_null(shown());
    assert_false(web_setup_code_waits(rig.code_path, now_s));
    assert_int_equal(look(), 1);
    assert_null(shown());
    web_first_code_free(rig.first);
    start(true);
    assert_int_equal(look(), 1);
    expect_shown_and_valid();
    char *after = shown();
    assert_string_not_equal(before, after);
    free(before);
    free(after);
}

/* The server has made a code, and root then makes another one. */
static void root_replaces_the_code(char code[WEB_SETUP_CODE_SIZE])
{
    struct iso_fault fault = {.text = ""};

    start(true);
    assert_int_equal(look(), 1);
    assert_int_equal(web_setup_code_make(rig.code_path, now_s, code, &fault), 0);
    assert_int_equal(look(), 1);
}

/* An hour after the start, a code of root is not touched. */
static void the_code_of_root_outlives_the_hour(void **state)
{
    char code[WEB_SETUP_CODE_SIZE];
    (void)state;

    root_replaces_the_code(code);
    up_s += WEB_FIRST_CODE_HELD_S;
    assert_int_equal(look(), 1);
    assert_true(web_setup_code_is(rig.code_path, now_s, code));
}

/* Nobody can read the code of an earlier start any more. */
static void a_start_makes_a_new_code(void **state)
{
    char code[WEB_SETUP_CODE_SIZE];
    struct iso_fault fault = {.text = ""};
    (void)state;

    assert_int_equal(web_setup_code_make(rig.code_path, now_s, code, &fault), 0);
    start(true);
    assert_int_equal(look(), 1);
    expect_shown_and_valid();
    assert_false(web_setup_code_is(rig.code_path, now_s, code));
}

static void a_code_of_root_stays(void **state)
{
    char code[WEB_SETUP_CODE_SIZE];
    (void)state;

    root_replaces_the_code(code);
    assert_null(shown());
    assert_true(web_setup_code_is(rig.code_path, now_s, code));
}

static void without_the_option_there_is_no_code(void **state)
{
    (void)state;
    start(false);
    assert_int_equal(look(), 1);
    assert_null(shown());
    assert_false(web_setup_code_waits(rig.code_path, now_s));
}

static void a_factory_reset_ends_the_server(void **state)
{
    struct iso_fault fault = {.text = ""};
    (void)state;

    assert_int_equal(
        web_accounts_add(rig.accounts, "ada", password, WEB_ROLE_ADMINISTRATOR, &fault), 0);
    start(false);
    assert_int_equal(look(), 1);
    assert_int_equal(unlink(rig.accounts_path), 0);
    assert_int_equal(look(), -ESTALE);
}

int main(void)
{
#define ON_RIG(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
    const struct CMUnitTest tests[] = {
        ON_RIG(a_code_waits_until_there_is_an_account),
        ON_RIG(a_code_that_has_ended_is_followed_by_the_next),
        ON_RIG(after_an_hour_there_is_no_code_until_the_next_start),
        ON_RIG(the_code_of_root_outlives_the_hour),
        ON_RIG(a_start_makes_a_new_code),
        ON_RIG(a_code_of_root_stays),
        ON_RIG(without_the_option_there_is_no_code),
        ON_RIG(a_factory_reset_ends_the_server),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
