/* Join addresses, the key of the certificate, and when it is renewed. */
#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "firmware/fleet/program/home.h"
#include "firmware/fleet/program/join_address.h"
#include "firmware/fleet/program/renew.h"
#include "firmware/fleet/program/tls_key.h"
#include "tests/firmware/fleet/link/certificates.h"
#include "tests/firmware/rigs/cmocka_headers.h"
#include "tests/support/scratch.h"

#define CA "0123456789abcdef0123456789abcdef0123456789abcdef0123456789ABCDEF"

static void addresses_are_read(void **state)
{
    struct link_join_address address;
    struct iso_fault fault;

    (void)state;
    assert_int_equal(link_join_address_read("isotherm://hub.example:8443/?ca=" CA "&code=ABC234",
                                            &address, &fault),
                     0);
    assert_string_equal(address.url, "https://hub.example:8443");
    assert_string_equal(address.code, "ABC234");
    assert_int_equal(address.ca[0], 0x01);
    assert_int_equal(address.ca[31], 0xef);
    assert_int_equal(link_join_address_read("isotherm://[2001:db8::1]:1?later=x&code=Z&ca=" CA,
                                            &address, &fault),
                     0);
    assert_string_equal(address.url, "https://[2001:db8::1]:1");
}

static void bad_addresses_are_refused(void **state)
{
    static const char *const bad[] = {
        "",
        "https://hub:1/?ca=" CA "&code=A",
        "isotherm://",
        "isotherm://hub/?ca=" CA "&code=A",
        "isotherm://:1/?ca=" CA "&code=A",
        "isotherm://hub:0/?ca=" CA "&code=A",
        "isotherm://hub:65536/?ca=" CA "&code=A",
        "isotherm://hub:1x/?ca=" CA "&code=A",
        "isotherm://user@hub:1/?ca=" CA "&code=A",
        "isotherm://hub\n:1/?ca=" CA "&code=A",
        "isotherm://[::1:1/?ca=" CA "&code=A",
        "isotherm://hub:1/path?ca=" CA "&code=A",
        "isotherm://hub:1/",
        "isotherm://hub:1/?code=A",
        "isotherm://hub:1/?ca=" CA,
        "isotherm://hub:1/?ca=" CA "&code=",
        "isotherm://hub:1/?ca=" CA "0&code=A",
        "isotherm://hub:1/?ca=00&code=A",
        "isotherm://hub:1/?ca=" CA "&code=A\"B",
    };
    struct link_join_address address = {.url = "untouched"};
    struct iso_fault fault;

    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        fault.text[0] = '\0';
        assert_int_equal(link_join_address_read(bad[i], &address, &fault), -EINVAL);
        assert_true(fault.text[0]);
    }
    assert_string_equal(address.url, "untouched");
}

static void a_request_is_signed_by_its_key(void **state)
{
    struct authority authority;
    struct iso_fault fault;
    char *key = NULL, *other = NULL, *csr = NULL, certificate[4096];
    uint8_t digest[32];
    int64_t ends_s = 0;

    (void)state;
    authority_make(&authority);
    assert_int_equal(link_tls_key_make(&key, &fault), 0);
    assert_int_equal(link_tls_key_make(&other, &fault), 0);
    assert_int_equal(link_tls_request(key, "east", &csr, &fault), 0);
    authority_sign(&authority, csr, "door", certificate);
    assert_true(link_tls_fits(certificate, key));
    assert_false(link_tls_fits(certificate, other));
    assert_int_equal(link_tls_examine(certificate, digest, &ends_s, &fault), 0);
    assert_in_range(ends_s, time(NULL) + 89 * 86400, time(NULL) + 91 * 86400);
    assert_int_equal(link_tls_examine("no certificate", digest, &ends_s, &fault), -EBADMSG);
    assert_int_equal(link_tls_request("no key", "east", &csr, &fault), -EBADMSG);
    free(csr);
    free(key);
    free(other);
    authority_free(&authority);
}

static void a_certificate_is_renewed_when_a_third_is_left(void **state)
{
    (void)state;
    assert_false(link_renew_is_due(1000, 1090, 1000));
    assert_false(link_renew_is_due(1000, 1090, 1059));
    assert_true(link_renew_is_due(1000, 1090, 1060));
    assert_true(link_renew_is_due(1000, 1090, 2000));
    /* The certificate was stored while the clock of the door was wrong and showed a later time. It
     * is not renewed before its end. */
    assert_false(link_renew_is_due(5000, 1090, 1000));
    assert_true(link_renew_is_due(5000, 1090, 1090));
    assert_true(link_renew_is_due(INT64_MIN / 4, INT64_MAX / 4, INT64_MAX));
}

static void the_folder_is_written_and_read(void **state)
{
    struct link_home home = {.hub_url = "https://hub:8443",
                             .broker_host = "broker.example",
                             .broker_port = 8883,
                             .door = {.bytes = {7, 7, 7, 7, 7, 7, 0x47, 7, 0x87}}};
    struct link_home read;
    struct iso_fault fault;

    assert_int_equal(link_home_read(*state, &read, &fault), -ENOENT);
    assert_int_equal(link_home_write(*state, &home, &fault), 0);
    assert_int_equal(link_home_read(*state, &read, &fault), 0);
    assert_string_equal(read.hub_url, home.hub_url);
    assert_string_equal(read.broker_host, home.broker_host);
    assert_int_equal(read.broker_port, 8883);
    assert_memory_equal(&read.door, &home.door, sizeof read.door);
    scratch_write_text(scratch_path(*state, LINK_HOME_CONF), "{\"door\": 1}");
    assert_int_equal(link_home_read(*state, &read, &fault), -EBADMSG);
    link_home_remove(*state);
    assert_false(scratch_exists(scratch_path(*state, LINK_HOME_CONF)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(addresses_are_read),
        cmocka_unit_test(bad_addresses_are_refused),
        cmocka_unit_test(a_request_is_signed_by_its_key),
        cmocka_unit_test(a_certificate_is_renewed_when_a_third_is_left),
        cmocka_unit_test_setup_teardown(the_folder_is_written_and_read, scratch_setup,
                                        scratch_teardown),
    };

    return sodium_init() < 0 ? 1 : cmocka_run_group_tests(tests, NULL, NULL);
}
