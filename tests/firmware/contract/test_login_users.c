/* The file that says which person a Unix user is: what it may contain, and who may have written
 * it. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/login_users.h"
#include "tests/support/scratch.h"

static char person[ISO_PERSON_NAME_SIZE];
static struct iso_fault fault;

/* Parses a text, which a string literal holds, for the user ada. */
static int parse_bytes(const char *bytes, size_t size)
{
    char *text = calloc(1, size + 1);
    assert_non_null(text);
    memcpy(text, bytes, size);
    (void)snprintf(person, sizeof person, "untouched");
    fault = (struct iso_fault){.text = ""};
    const int error = iso_login_users_parse("users", text, size, "ada", person, &fault);
    free(text);
    assert_int_equal(error == 0, fault.text[0] == '\0');
    assert_true(error == 0 || strcmp(person, "untouched") == 0);
    return error;
}

static int parse(const char *text)
{
    return parse_bytes(text, strlen(text));
}

static void finds_the_person_of_a_user(void **state)
{
    (void)state;
    assert_int_equal(parse("# who is who\n\nbob Bob\nada Ada Lovelace\nada2 Eve\n"), 0);
    assert_string_equal(person, "Ada Lovelace");
    assert_int_equal(parse("bob Zo\xc3\xab\r\nada Zo\xc3\xab"), 0);
    assert_string_equal(person, "Zo\xc3\xab");
}

static void a_user_who_is_not_named_has_no_person(void **state)
{
    (void)state;
    assert_int_equal(parse(""), -ESRCH);
    assert_int_equal(parse("# ada Ada\nAda Ada\nad Ada\nadam Ada\n"), -ESRCH);
    assert_string_equal(fault.text, "users: no person belongs to this user");
}

static void a_wrong_line_makes_the_whole_file_wrong(void **state)
{
    static const char *const wrong[] = {
        "ada Ada\nbob\n",          "ada Ada\nbob \n",         "ada Ada\n Bob\n",
        "ada Ada\nbob  Bob\n",     "ada Ada\nbob Bob \n",     "ada Ada\nbob\tBob\n",
        "ada Ada\nb:b Bob\n",      "ada Ada\n/bob Bob\n",     "ada Ada\nb\xc3\xb6 Bob\n",
        "ada Ada\nbob B\x1b[1m\n", "ada Ada\nbob \xff\xfe\n", "ada Ada\nbob B\xc2\x85\n",
    };
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_equal(parse(wrong[i]), -EBADMSG);
        assert_int_equal(strncmp(fault.text, "users:2: ", 9), 0);
    }
    assert_int_equal(parse("ada Ada\nbob Bob\nada Eve\n"), -EBADMSG);
    assert_string_equal(fault.text, "users:3: this user has an earlier line");
    assert_int_equal(parse_bytes("ada Ada\nada\0 Eve\n", 17), -EBADMSG);
}

static void names_are_as_long_as_they_may_be_and_no_longer(void **state)
{
    char text[1024], user[ISO_LOGIN_USER_BYTES + 2], name[ISO_PERSON_NAME_SIZE + 1];
    (void)state;
    memset(user, 'u', sizeof user);
    memset(name, 'n', sizeof name);
    name[ISO_PERSON_NAME_SIZE - 1] = '\0';
    (void)snprintf(text, sizeof text, "ada %s\n%.*s x\n", name, ISO_LOGIN_USER_BYTES, user);
    assert_int_equal(parse(text), 0);
    assert_string_equal(person, name);
    (void)snprintf(text, sizeof text, "ada %sn\n", name);
    assert_int_equal(parse(text), -EBADMSG);
    (void)snprintf(text, sizeof text, "ada Ada\n%.*s x\n", ISO_LOGIN_USER_BYTES + 1, user);
    assert_int_equal(parse(text), -EBADMSG);
}

/* ---- the file ---- */

static int find(const char *path, uid_t owner)
{
    fault = (struct iso_fault){.text = ""};
    return iso_login_users_find(path, owner, "ada", person, &fault);
}

static void only_its_owner_may_have_written_the_file(void **state)
{
    const char *path = scratch_path(*state, "users");
    scratch_write_text(path, "ada Ada\n");
    static const mode_t bad[] = {0620, 0602, 0666, 0640 | S_IWGRP, 0777};
    assert_int_equal(chmod(path, 0640), 0);
    assert_int_equal(find(path, geteuid()), 0);
    assert_string_equal(person, "Ada");
    assert_int_equal(find(path, geteuid() + 1), -EPERM);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(chmod(path, bad[i]), 0);
        assert_int_equal(find(path, geteuid()), -EPERM);
        assert_non_null(strstr(fault.text, "may write it"));
    }
}

static void nothing_but_a_short_file_is_read(void **state)
{
    char *link = strdup(scratch_path(*state, "link"));
    const char *path = scratch_path(*state, "users");
    assert_int_equal(find(path, geteuid()), -ENOENT);
    scratch_write_text(path, "ada Ada\n");
    assert_int_equal(chmod(path, 0600), 0);
    assert_int_equal(symlink(path, link), 0);
    assert_int_equal(find(link, geteuid()), -ELOOP);
    assert_int_equal(find(*state, geteuid()), -EISDIR);
    assert_int_equal(truncate(path, (64 << 10) + 1), 0);
    assert_int_equal(find(path, geteuid()), -EFBIG);
    free(link);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_the_person_of_a_user),
        cmocka_unit_test(a_user_who_is_not_named_has_no_person),
        cmocka_unit_test(a_wrong_line_makes_the_whole_file_wrong),
        cmocka_unit_test(names_are_as_long_as_they_may_be_and_no_longer),
        cmocka_unit_test_setup_teardown(only_its_owner_may_have_written_the_file, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(nothing_but_a_short_file_is_read, scratch_setup,
                                        scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
