/* The certificate of the web server: made once, kept, and refused when it is damaged. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/web/tls/certificate.h"

static char folder[64], key_path[96], chain_path[96];

static int setup(void **state)
{
    (void)state;
    (void)snprintf(folder, sizeof folder, "%s", "/tmp/isotherm-web.XXXXXX");
    assert_non_null(mkdtemp(folder));
    (void)snprintf(key_path, sizeof key_path, "%s/key.pem", folder);
    (void)snprintf(chain_path, sizeof chain_path, "%s/certificate.pem", folder);
    return 0;
}

static int teardown(void **state)
{
    (void)state;
    (void)unlink(key_path);
    (void)unlink(chain_path);
    return rmdir(folder);
}

static void it_is_made_once_with_a_private_key(void **state)
{
    struct web_certificate first, second;
    char fingerprint[WEB_FINGERPRINT_SIZE], command[256], told[256] = "";
    struct stat status;
    (void)state;
    assert_int_equal(web_certificate_fingerprint(folder, fingerprint, NULL), -ENOENT);
    assert_int_equal(web_certificate_open(folder, &first, NULL), 0);
    assert_int_equal(web_certificate_open(folder, &second, NULL), 0);
    assert_string_equal(first.fingerprint, second.fingerprint);
    assert_string_equal(first.key, second.key);
    assert_int_equal(web_certificate_fingerprint(folder, fingerprint, NULL), 0);
    assert_string_equal(fingerprint, first.fingerprint);
    assert_true(first.ends_s > time(NULL) + 3000L * 86400);
    assert_int_equal(stat(key_path, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0600);
    /* Another implementation reads the same. */
    (void)snprintf(command, sizeof command,
                   "openssl x509 -in %s -noout -fingerprint -sha256 2>/dev/null", chain_path);
    FILE *openssl = popen(command, "r");
    assert_non_null(openssl);
    if (fgets(told, sizeof told, openssl)) {
        assert_non_null(strstr(told, first.fingerprint));
    }
    (void)pclose(openssl);
    web_certificate_free(&first);
    web_certificate_free(&second);
}

static void a_damaged_or_foreign_file_is_refused(void **state)
{
    struct web_certificate made, other;
    struct iso_fault fault;
    (void)state;
    assert_int_equal(web_certificate_open(folder, &made, NULL), 0);
    assert_int_equal(truncate(chain_path, 100), 0);
    assert_int_equal(web_certificate_open(folder, &other, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, chain_path));
    assert_int_equal(unlink(chain_path), 0);
    assert_int_equal(web_certificate_open(folder, &other, NULL), 0);
    assert_string_not_equal(made.fingerprint, other.fingerprint);
    FILE *file = fopen(key_path, "w");
    assert_non_null(file);
    assert_true(fputs(made.key, file) >= 0);
    assert_int_equal(fclose(file), 0);
    web_certificate_free(&other);
    assert_int_equal(web_certificate_open(folder, &other, &fault), -EBADMSG);
    web_certificate_free(&made);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(it_is_made_once_with_a_private_key),
        TEST(a_damaged_or_foreign_file_is_refused),
    };
    return sodium_init() < 0 ? 1 : cmocka_run_group_tests(tests, NULL, NULL);
}
