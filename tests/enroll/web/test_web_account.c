/* The accounts of the web server: their file, their passwords, the one-time code, and guessing. */
#include <errno.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/web/account/account.h"
#include "enroll/web/account/guess.h"
#include "enroll/web/account/setup_code.h"

static const char password[] = "correct horse battery";
static const int64_t SECOND_NS = 1000000000;

static char folder[64], path[96];

static int setup(void **state)
{
    (void)state;
    (void)snprintf(folder, sizeof folder, "%s", "/tmp/isotherm-web.XXXXXX");
    assert_non_null(mkdtemp(folder));
    (void)snprintf(path, sizeof path, "%s/accounts.json", folder);
    return 0;
}

static int teardown(void **state)
{
    (void)state;
    (void)unlink(path);
    return rmdir(folder);
}

static void write_file(const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void accounts_survive_a_restart_in_a_private_file(void **state)
{
    struct web_accounts *accounts = NULL;
    struct stat status;
    (void)state;
    assert_int_equal(web_accounts_open(path, &accounts, NULL), 0);
    assert_int_equal(web_accounts_count(accounts), 0);
    assert_int_equal(web_accounts_add(accounts, "ada", password, WEB_ROLE_ADMINISTRATOR, NULL), 0);
    assert_int_equal(web_accounts_add(accounts, "bob", password, WEB_ROLE_OBSERVER, NULL), 0);
    assert_int_equal(web_accounts_add(accounts, "bob", password, WEB_ROLE_OBSERVER, NULL), -EEXIST);
    web_accounts_close(accounts);
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0600);
    assert_int_equal(web_accounts_open(path, &accounts, NULL), 0);
    assert_int_equal(web_accounts_count(accounts), 2);
    const struct web_account *ada = web_accounts_find(accounts, "ada");
    assert_int_equal(ada->role, WEB_ROLE_ADMINISTRATOR);
    assert_int_equal(strncmp(ada->hash, "$argon2id$", 10), 0);
    assert_true(web_password_is(password, ada->hash));
    assert_false(web_password_is("correct horse batterz", ada->hash));
    assert_false(web_password_is(password, NULL));
    assert_string_not_equal(ada->hash, web_accounts_find(accounts, "bob")->hash);
    web_accounts_close(accounts);
}

static void the_last_administrator_stays(void **state)
{
    struct web_accounts *accounts = NULL;
    struct iso_fault fault;
    (void)state;
    assert_int_equal(web_accounts_open(path, &accounts, NULL), 0);
    assert_int_equal(web_accounts_add(accounts, "ada", password, WEB_ROLE_ADMINISTRATOR, NULL), 0);
    assert_int_equal(web_accounts_add(accounts, "bob", password, WEB_ROLE_ENROLLER, NULL), 0);
    assert_int_equal(web_accounts_remove(accounts, "ada", &fault), -EBUSY);
    assert_string_equal(fault.text, "this is the last administrator");
    assert_int_equal(web_accounts_set_role(accounts, "ada", WEB_ROLE_OBSERVER, NULL), -EBUSY);
    assert_int_equal(web_accounts_set_role(accounts, "bob", WEB_ROLE_ADMINISTRATOR, NULL), 0);
    assert_int_equal(web_accounts_remove(accounts, "ada", NULL), 0);
    assert_int_equal(web_accounts_remove(accounts, "ada", NULL), -ENOENT);
    assert_int_equal(web_accounts_set_password(accounts, "bob", "another long password", NULL), 0);
    assert_true(web_password_is("another long password", web_accounts_find(accounts, "bob")->hash));
    web_accounts_close(accounts);
}

static void names_and_passwords_that_are_weak_are_refused(void **state)
{
    struct web_accounts *accounts = NULL;
    (void)state;
    static const char *const names[] = {"",    "Ada",      "1ada",
                                        "a b", "\xc3\xa4", "abcdefghijklmnopqrstuvwxyz0123456"};
    static const char *const passwords[] = {"", "short", "aaaaaaaaaaaaaaaa", "administrator1",
                                            "\xff\xff long enough but no text"};
    assert_int_equal(web_accounts_open(path, &accounts, NULL), 0);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        assert_int_equal(web_accounts_add(accounts, names[i], password, WEB_ROLE_OBSERVER, NULL),
                         -EINVAL);
    }
    for (size_t i = 0; i < sizeof passwords / sizeof *passwords; i++) {
        assert_int_equal(
            web_accounts_add(accounts, "administrator", passwords[i], WEB_ROLE_OBSERVER, NULL),
            -EINVAL);
    }
    assert_int_equal(web_accounts_add(accounts, "ada", password, WEB_ROLE_NONE, NULL), -EINVAL);
    assert_int_equal(web_accounts_count(accounts), 0);
    web_accounts_close(accounts);
}

static void a_damaged_file_is_refused_as_a_whole(void **state)
{
    struct web_accounts *accounts = NULL;
    struct iso_fault fault;
    (void)state;
    static const char *const texts[] = {
        "",
        "{}",
        "[]",
        "{\"version\": 2, \"accounts\": []}",
        "{\"version\": 1, \"accounts\": [{\"name\": \"ada\", \"role\": \"god\", \"hash\": "
        "\"$argon2id$x\"}]}",
        "{\"version\": 1, \"accounts\": [{\"name\": \"ada\", \"role\": \"observer\", \"hash\": "
        "\"plain\"}]}",
        "{\"version\": 1, \"accounts\": [{\"name\": \"ada\", \"role\": \"observer\", \"hash\": "
        "\"$argon2id$x\", \"more\": 1}]}",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        write_file(texts[i]);
        assert_int_equal(web_accounts_open(path, &accounts, &fault), -EBADMSG);
        assert_non_null(strstr(fault.text, path));
    }
}

static void a_code_is_used_once_and_ends(void **state)
{
    char code[WEB_SETUP_CODE_SIZE], typed[64];
    (void)state;
    assert_false(web_setup_code_waits(path, 1000));
    assert_int_equal(web_setup_code_use(path, 1000, "AAAAA-AAAAA-AAAAA-AAAAA", NULL), -EACCES);
    assert_int_equal(web_setup_code_make(path, 1000, code, NULL), 0);
    assert_int_equal(strlen(code), WEB_SETUP_CODE_SIZE - 1);
    assert_true(web_setup_code_waits(path, 1000 + WEB_SETUP_CODE_VALID_S - 1));
    assert_false(web_setup_code_waits(path, 1000 + WEB_SETUP_CODE_VALID_S));
    assert_false(web_setup_code_waits(path, 999));
    assert_int_equal(web_setup_code_use(path, 1001, "AAAAA-AAAAA-AAAAA-AAAAA", NULL), -EACCES);
    assert_int_equal(web_setup_code_use(path, 1001, "", NULL), -EACCES);
    for (size_t i = 0; i <= strlen(code); i++) {
        typed[i] = (char)(code[i] >= 'A' ? code[i] + 32 : code[i] == '-' ? ' ' : code[i]);
    }
    assert_int_equal(web_setup_code_use(path, 1001, typed, NULL), 0);
    assert_int_equal(web_setup_code_use(path, 1001, code, NULL), -EACCES);
}

static struct sockaddr_in address_of(uint32_t number)
{
    return (struct sockaddr_in){.sin_family = AF_INET, .sin_addr.s_addr = htonl(number)};
}

static void guessing_waits_longer_and_longer(void **state)
{
    static struct web_guess guess;
    const struct sockaddr_in one = address_of(0x0a000001), two = address_of(0x0a000002);
    const struct sockaddr *here = (const struct sockaddr *)&one;
    const struct sockaddr *there = (const struct sockaddr *)&two;
    int64_t now = 5 * SECOND_NS, longest = 0;
    (void)state;
    web_guess_init(&guess);
    for (int i = 0; i < WEB_GUESS_FREE; i++) {
        assert_int_equal(web_guess_wait_ns(&guess, "ada", here, now), 0);
        web_guess_failed(&guess, "ada", here, now);
    }
    assert_int_equal(web_guess_wait_ns(&guess, "ada", here, now), SECOND_NS);
    for (int i = 0; i < 40; i++) {
        now += web_guess_wait_ns(&guess, "ada", here, now);
        web_guess_failed(&guess, "ada", here, now);
        longest = web_guess_wait_ns(&guess, "ada", here, now);
    }
    assert_int_equal(longest, WEB_GUESS_ADDRESS_MOST_S * SECOND_NS);
    /* Somebody else cannot keep the account locked for long. */
    assert_true(web_guess_wait_ns(&guess, "ada", there, now) <=
                WEB_GUESS_ACCOUNT_MOST_S * SECOND_NS);
    web_guess_passed(&guess, "ada");
    assert_int_equal(web_guess_wait_ns(&guess, "ada", there, now), 0);
    assert_int_equal(web_guess_wait_ns(&guess, "ada", here, now), longest);
    now += (WEB_GUESS_FORGET_S + 1) * SECOND_NS;
    assert_int_equal(web_guess_wait_ns(&guess, "ada", here, now), 0);
}

static struct sockaddr_in6 ipv6_of(uint8_t network, uint8_t host)
{
    struct sockaddr_in6 address = {.sin6_family = AF_INET6};

    address.sin6_addr.s6_addr[0] = 0xfd;
    address.sin6_addr.s6_addr[7] = network;
    address.sin6_addr.s6_addr[15] = host;
    return address;
}

/* All clients in a building may have one network of IPv6. */
static void guessing_delays_the_network_for_a_minute(void **state)
{
    static struct web_guess guess;
    const struct sockaddr_in6 one = ipv6_of(1, 1), two = ipv6_of(1, 2), other = ipv6_of(2, 1);
    const struct sockaddr *here = (const struct sockaddr *)&one;
    const int64_t now = 5 * SECOND_NS;
    (void)state;
    web_guess_init(&guess);
    memset(guess.key, 7, sizeof guess.key); /* no two of these share an entry by chance */
    for (int i = 0; i < 40; i++) {
        web_guess_failed(&guess, "ada", here, now);
    }
    web_guess_passed(&guess, "ada");
    assert_int_equal(web_guess_wait_ns(&guess, "ada", here, now),
                     WEB_GUESS_ADDRESS_MOST_S * SECOND_NS);
    assert_int_equal(web_guess_wait_ns(&guess, "ada", (const struct sockaddr *)&two, now),
                     WEB_GUESS_NETWORK_MOST_S * SECOND_NS);
    assert_int_equal(web_guess_wait_ns(&guess, "ada", (const struct sockaddr *)&other, now), 0);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(accounts_survive_a_restart_in_a_private_file),
        TEST(the_last_administrator_stays),
        TEST(names_and_passwords_that_are_weak_are_refused),
        TEST(a_damaged_file_is_refused_as_a_whole),
        TEST(a_code_is_used_once_and_ends),
        TEST(guessing_waits_longer_and_longer),
        TEST(guessing_delays_the_network_for_a_minute),
    };
    return sodium_init() < 0 ? 1 : cmocka_run_group_tests(tests, NULL, NULL);
}
