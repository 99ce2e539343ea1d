/* Sessions of the web server, the cookie, and where a request comes from. */
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/web/session/note_limit.h"
#include "enroll/web/session/origin.h"
#include "enroll/web/session/session.h"

static const int64_t SECOND_NS = 1000000000;
static struct web_sessions sessions;

static struct web_account account(const char *name, enum web_role role)
{
    struct web_account made = {.role = role};
    (void)snprintf(made.name, sizeof made.name, "%s", name);
    return made;
}

static int setup(void **state)
{
    (void)state;
    memset(&sessions, 0, sizeof sessions);
    return 0;
}

static void a_session_ends_when_it_is_idle_or_old(void **state)
{
    const struct web_account ada = account("ada", WEB_ROLE_ENROLLER);
    char token[WEB_SESSION_TOKEN_SIZE];
    int64_t now = SECOND_NS;
    (void)state;
    const uint64_t id = web_session_begin(&sessions, &ada, now, token);
    assert_int_equal(strlen(token), WEB_SESSION_TOKEN_SIZE - 1);
    assert_null(memmem(&sessions, sizeof sessions, token, strlen(token)));
    const struct web_session *found = web_session_use(&sessions, token, now);
    assert_non_null(found);
    assert_string_equal(found->account, "ada");
    assert_int_equal(found->role, WEB_ROLE_ENROLLER);
    assert_null(web_session_use(&sessions, "", now));
    assert_true(web_session_goes_on(&sessions, id, now + (WEB_SESSION_IDLE_S - 1) * SECOND_NS));
    assert_null(web_session_use(&sessions, token, now + WEB_SESSION_IDLE_S * SECOND_NS));
    int64_t t = now;
    while (web_session_use(&sessions, token, t)) {
        t += 60 * SECOND_NS;
    }
    assert_int_equal((t - now) / SECOND_NS, WEB_SESSION_LIFE_S);
}

static void a_table_that_is_full_ends_the_session_used_least(void **state)
{
    char first[WEB_SESSION_TOKEN_SIZE], token[WEB_SESSION_TOKEN_SIZE], name[16];
    (void)state;
    const struct web_account ada = account("ada", WEB_ROLE_OBSERVER);
    (void)web_session_begin(&sessions, &ada, 1, first);
    for (int i = 1; i < WEB_SESSIONS_OF_ACCOUNT; i++) {
        (void)web_session_begin(&sessions, &ada, 1 + i, token);
    }
    assert_non_null(web_session_use(&sessions, first, 20));
    (void)web_session_begin(&sessions, &ada, 21, token);
    assert_non_null(web_session_use(&sessions, first, 22));
    for (int i = 0; i < 2 * WEB_SESSIONS_MOST; i++) {
        (void)snprintf(name, sizeof name, "user%d", i);
        const struct web_account user = account(name, WEB_ROLE_OBSERVER);
        (void)web_session_begin(&sessions, &user, 30 + i, token);
        assert_non_null(web_session_use(&sessions, token, 30 + i));
    }
    assert_null(web_session_use(&sessions, first, 1000));
}

static void an_account_that_changes_loses_its_other_sessions(void **state)
{
    const struct web_account ada = account("ada", WEB_ROLE_OBSERVER);
    const struct web_account bob = account("bob", WEB_ROLE_OBSERVER);
    char here[WEB_SESSION_TOKEN_SIZE], there[WEB_SESSION_TOKEN_SIZE], other[WEB_SESSION_TOKEN_SIZE];
    (void)state;
    const uint64_t id = web_session_begin(&sessions, &ada, 1, here);
    (void)web_session_begin(&sessions, &ada, 1, there);
    (void)web_session_begin(&sessions, &bob, 1, other);
    web_session_end_account(&sessions, "ada", id);
    assert_non_null(web_session_use(&sessions, here, 2));
    assert_null(web_session_use(&sessions, there, 2));
    assert_non_null(web_session_use(&sessions, other, 2));
    web_session_end(&sessions, id);
    assert_null(web_session_use(&sessions, here, 2));
}

static void the_cookie_is_read_and_written(void **state)
{
    char token[WEB_SESSION_TOKEN_SIZE], text[WEB_SESSION_SET_COOKIE_SIZE], header[256];
    static const char value[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQ";
    (void)state;
    (void)snprintf(header, sizeof header, "a=b; " WEB_SESSION_COOKIE "=%s; c=d", value);
    assert_true(web_session_cookie_token(header, token));
    assert_string_equal(token, value);
    assert_false(web_session_cookie_token("", token));
    assert_false(web_session_cookie_token(WEB_SESSION_COOKIE "=short", token));
    (void)snprintf(header, sizeof header, WEB_SESSION_COOKIE "=%s; " WEB_SESSION_COOKIE "=%s",
                   value, value);
    assert_false(web_session_cookie_token(header, token));
    assert_string_equal(web_session_set_cookie(value, text),
                        "__Host-isotherm=abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQ; Path=/; "
                        "Secure; HttpOnly; SameSite=Strict");
    assert_non_null(strstr(web_session_set_cookie(NULL, text), "Max-Age=0"));
}

static void only_the_own_pages_may_change_something(void **state)
{
    static const struct {
        const char *host, *origin, *site;
        bool change, read;
    } cases[] = {
        {"door:8443", "https://door:8443", "same-origin", true, true},
        {"door:8443", NULL, "same-origin", true, true},
        {"door:8443", "https://door:8443", NULL, true, true},
        {"door:8443", NULL, NULL, false, true},
        {"door:8443", NULL, "none", false, true},
        {"door:8443", NULL, "same-site", false, false},
        {"door:8443", NULL, "cross-site", false, false},
        {"door:8443", "https://door", "same-origin", false, false},
        {"door:8443", "http://door:8443", NULL, false, false},
        {"door:8443", "https://evil.example", NULL, false, false},
        {"door:8443", "null", NULL, false, false},
        {NULL, "https://", NULL, false, false},
        {"", "https://", NULL, false, false},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct web_origin origin = {cases[i].host, cases[i].origin, cases[i].site};
        assert_int_equal(web_origin_may_change(&origin), cases[i].change);
        assert_int_equal(web_origin_may_read(&origin), cases[i].read);
    }
}

/* ---- how often a login is recorded ---- */

static int recorded_of(struct web_note_limit *limit, const char *account, int n, int64_t now_ns,
                       uint32_t *left_out)
{
    int recorded = 0;
    for (int i = 0; i < n; i++) {
        recorded += web_note_limit_take(limit, account, now_ns, left_out);
    }
    return recorded;
}

static void logins_without_end_do_not_fill_the_log(void **state)
{
    static struct web_note_limit limit;
    const int64_t every_ns = WEB_NOTE_EVERY_S * INT64_C(1000000000);
    int64_t now_ns = 7;
    uint32_t left_out = 99;
    (void)state;
    assert_int_equal(recorded_of(&limit, "ada", 1000, now_ns, &left_out), WEB_NOTES_AT_ONCE);
    assert_int_equal(left_out, 0);
    assert_int_equal(recorded_of(&limit, "eve", 1, now_ns, &left_out), 1);
    now_ns += every_ns - 1;
    assert_int_equal(recorded_of(&limit, "ada", 1, now_ns, &left_out), 0);
    now_ns += 2;
    assert_int_equal(recorded_of(&limit, "ada", 5, now_ns, &left_out), 1);
    assert_int_equal(left_out, 1000 - WEB_NOTES_AT_ONCE + 1);
    now_ns += 1000 * every_ns;
    assert_int_equal(recorded_of(&limit, "ada", 1000, now_ns, &left_out), WEB_NOTES_AT_ONCE);
}

/* Names of accounts that are gone make room. */
static void as_many_accounts_as_there_may_be_have_a_limit_each(void **state)
{
    static struct web_note_limit limit;
    char name[WEB_ACCOUNT_NAME_SIZE];
    uint32_t left_out = 0;
    (void)state;
    for (int round = 0; round < 2; round++) {
        for (int i = 0; i < WEB_ACCOUNTS_MOST; i++) {
            (void)snprintf(name, sizeof name, "%c%d", 'a' + round, i);
            assert_int_equal(recorded_of(&limit, name, 50, 100 * round + i, &left_out),
                             WEB_NOTES_AT_ONCE);
        }
    }
    assert_int_equal(recorded_of(&limit, "b7", 50, 300, &left_out), 0);
    assert_int_equal(recorded_of(&limit, "a7", 50, 300, &left_out), WEB_NOTES_AT_ONCE);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup(f, setup)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(logins_without_end_do_not_fill_the_log),
        cmocka_unit_test(as_many_accounts_as_there_may_be_have_a_limit_each),
        TEST(a_session_ends_when_it_is_idle_or_old),
        TEST(a_table_that_is_full_ends_the_session_used_least),
        TEST(an_account_that_changes_loses_its_other_sessions),
        TEST(the_cookie_is_read_and_written),
        TEST(only_the_own_pages_may_change_something),
    };
    return sodium_init() < 0 ? 1 : cmocka_run_group_tests(tests, NULL, NULL);
}
