/* How entries of an LDAP directory are understood. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>

#include "enroll/hub/directory/ldap_map.h"

static void a_map_names_attributes(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct hub__ldap_map map;
    (void)state;
    assert_int_equal(hub__ldap_map_read(NULL, &map, &fault), 0);
    assert_string_equal(map.id, "entryUUID");
    assert_string_equal(map.until, "");
    assert_int_equal(hub__ldap_map_read("name=displayName,until=accountExpires", &map, &fault), 0);
    assert_string_equal(map.name, "displayName");
    assert_string_equal(map.until, "accountExpires");
    assert_string_equal(map.group, "memberOf");
    static const char *const wrong[] = {"name", "name=", "nick=cn", "name=a b", ",", "name=cn,,"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_equal(hub__ldap_map_read(wrong[i], &map, &fault), -EINVAL);
    }
}

static void groups_locks_and_ids_are_understood(void **state)
{
    char id[HUB_EXTERNAL_SIZE];
    (void)state;
    assert_true(hub__ldap_is_group("cn=Staff,dc=example", "staff"));
    assert_true(hub__ldap_is_group("cn=Staff,dc=example", "CN=staff,DC=example"));
    assert_true(hub__ldap_is_group("Staff", "staff"));
    assert_false(hub__ldap_is_group("cn=Staff2,dc=example", "staff"));
    assert_false(hub__ldap_is_group("cn=other,ou=staff", "staff"));
    assert_true(hub__ldap_is_disabled("userAccountControl", "514"));
    assert_false(hub__ldap_is_disabled("userAccountControl", "512"));
    assert_true(hub__ldap_is_disabled("nsAccountLock", "TRUE"));
    assert_false(hub__ldap_is_disabled("nsAccountLock", "false"));
    assert_int_equal(hub__ldap_id("\x01\x00\xff", 3, id), 0);
    assert_string_equal(id, "0100ff");
    assert_int_equal(hub__ldap_id("f47a-1", 6, id), 0);
    assert_string_equal(id, "f47a-1");
    assert_int_equal(hub__ldap_id("", 0, id), -EINVAL);
}

static void times_are_understood(void **state)
{
    int64_t time_s = 1;
    (void)state;
    assert_int_equal(hub__ldap_time("20261231235959Z", &time_s), 0);
    assert_int_equal(time_s, 1798761599);
    assert_int_equal(hub__ldap_time("20261231235959.0Z", &time_s), 0);
    assert_int_equal(hub__ldap_time("134432351990000000", &time_s), 0);
    assert_int_equal(time_s, 1798761599);
    assert_int_equal(hub__ldap_time("0", &time_s), 0);
    assert_int_equal(time_s, 0);
    assert_int_equal(hub__ldap_time("9223372036854775807", &time_s), 0);
    assert_int_equal(time_s, 0);
    static const char *const wrong[] = {"",
                                        "soon",
                                        "20261231",
                                        "20261231235959",
                                        "17",
                                        "20261231235959+0100",
                                        "99999999999999999999"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_equal(hub__ldap_time(wrong[i], &time_s), -EINVAL);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_map_names_attributes),
        cmocka_unit_test(groups_locks_and_ids_are_understood),
        cmocka_unit_test(times_are_understood),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
