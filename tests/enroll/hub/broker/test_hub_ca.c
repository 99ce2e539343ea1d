/* The authority of the hub: made once, kept, refused when it is damaged; what it signs for doors
 * and for itself is judged by another implementation, OpenSSL's program. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/hub/broker/hub_ca.h"
#include "enroll/hub/broker/hub_pair.h"
#include "firmware/fleet/message/envelope.h"
#include "tests/support/scratch.h"

static const char *folder;

static struct hub_ca *open_ca(void)
{
    struct iso_fault fault = {.text = ""};
    struct hub_ca *ca = NULL;

    if (hub_ca_open(folder, &ca, &fault)) {
        fail_msg("%s", fault.text);
    }
    return ca;
}

static int setup(void **state)
{
    struct iso_fault fault;

    assert_int_equal(iso_fleet_start(&fault), 0);
    assert_int_equal(scratch_setup(state), 0);
    folder = *state;
    return 0;
}

/* Whether a command succeeds in the folder; what it prints is in `told`. */
static bool told_by(const char *command, char *told, size_t size)
{
    char line[1024];

    (void)snprintf(line, sizeof line, "cd %s && (%s) 2>&1", folder, command);
    FILE *pipe = popen(line, "r");
    assert_non_null(pipe);
    const size_t n = fread(told, 1, size - 1, pipe);
    told[n] = '\0';
    return pclose(pipe) == 0;
}

static void must(const char *command)
{
    char told[8192];

    if (!told_by(command, told, sizeof told)) {
        fail_msg("%s: %s", command, told);
    }
}

static void must_not(const char *command, const char *why)
{
    char told[8192];

    assert_false(told_by(command, told, sizeof told));
    if (!strstr(told, why)) {
        fail_msg("%s: %s", command, told);
    }
}

static void the_authority_is_made_once(void **state)
{
    struct hub_ca *first = open_ca(), *second = open_ca();
    char told[256], digest[65];
    struct stat status;
    (void)state;

    assert_string_equal(hub_ca_pem(first), hub_ca_pem(second));
    assert_memory_equal(hub_ca_digest(first), hub_ca_digest(second), HUB_CA_DIGEST_BYTES);
    assert_int_equal(stat(scratch_path(folder, "ca-key.pem"), &status), 0);
    assert_int_equal(status.st_mode & 0777, 0600);
    for (int i = 0; i < 32; i++) {
        (void)snprintf(digest + 2L * i, 3, "%02x", hub_ca_digest(first)[i]);
    }
    assert_true(told_by("openssl x509 -in ca.pem -outform DER | sha256sum", told, sizeof told));
    assert_memory_equal(told, digest, 64);
    must("openssl verify -x509_strict -CAfile ca.pem ca.pem");
    must("openssl x509 -in ca.pem -noout -checkend $((3600 * 24 * 3649))");
    hub_ca_free(first);
    hub_ca_free(second);
}

static void a_half_or_foreign_authority_is_refused(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct hub_ca *ca = open_ca();
    (void)state;

    hub_ca_free(ca);
    must("mv ca-key.pem kept.pem");
    assert_int_equal(hub_ca_open(folder, &ca, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "ca-key.pem"));
    must("openssl ecparam -name prime256v1 -genkey -noout -out ca-key.pem");
    assert_int_equal(hub_ca_open(folder, &ca, &fault), -EBADMSG);
    must("mv kept.pem ca-key.pem && head -c 100 ca.pem > cut.pem && mv cut.pem ca.pem");
    assert_int_equal(hub_ca_open(folder, &ca, &fault), -EBADMSG);
    must("rm ca.pem");
    assert_int_equal(hub_ca_open(folder, &ca, &fault), -ENOENT);
}

static int sign_file(struct hub_ca *ca, const char *name, const struct iso_fleet_id *door,
                     struct hub_door_certificate *out)
{
    struct iso_fault fault = {.text = ""};
    char *csr = scratch_read_text(scratch_path(folder, name));
    const int r = hub_ca_sign_door(ca, csr, strlen(csr), door, time(NULL), out, &fault);

    free(csr);
    return r;
}

static void a_door_gets_its_own_name_and_nothing_more(void **state)
{
    struct hub_ca *ca = open_ca();
    const struct iso_fleet_id door = iso_fleet_id_random();
    char id[ISO_FLEET_ID_TEXT_SIZE], told[8192];
    struct hub_door_certificate made;
    (void)state;

    must("openssl req -new -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout k.pem "
         "-subj /CN=hub/O=evil -addext basicConstraints=CA:TRUE "
         "-addext subjectAltName=DNS:broker -out d.csr");
    assert_int_equal(sign_file(ca, "d.csr", &door, &made), 0);
    scratch_write_text(scratch_path(folder, "d.pem"), made.pem);
    must("openssl verify -x509_strict -purpose sslclient -CAfile ca.pem d.pem");
    must_not("openssl verify -purpose sslserver -CAfile ca.pem d.pem", "purpose");
    must_not("openssl x509 -in d.pem -noout -checkend $((3600 * 24 * 91))", "will expire");
    must("openssl x509 -in d.pem -noout -checkend $((3600 * 24 * 89))");
    assert_true(told_by("openssl x509 -in d.pem -noout -subject -text", told, sizeof told));
    char subject[80];
    (void)snprintf(subject, sizeof subject, "subject=CN = %s\n", iso_fleet_id_text(&door, id));
    assert_non_null(strstr(told, subject));
    assert_null(strstr(told, "evil"));
    assert_null(strstr(told, "DNS:broker"));
    assert_null(strstr(told, "CA:TRUE"));
    free(made.pem);
    hub_ca_free(ca);
}

static void a_bad_request_is_refused(void **state)
{
    struct hub_ca *ca = open_ca();
    const struct iso_fleet_id door = iso_fleet_id_random();
    struct hub_door_certificate made;
    (void)state;

    must("openssl req -new -newkey rsa:2048 -nodes -keyout k.pem -subj /CN=x -out rsa.csr");
    assert_int_equal(sign_file(ca, "rsa.csr", &door, &made), -EKEYREJECTED);
    must("openssl req -new -newkey ec -pkeyopt ec_paramgen_curve:P-384 -nodes -keyout k.pem "
         "-subj /CN=x -out p384.csr");
    assert_int_equal(sign_file(ca, "p384.csr", &door, &made), -EKEYREJECTED);
    scratch_write_text(scratch_path(folder, "no.csr"), "none");
    assert_int_equal(sign_file(ca, "no.csr", &door, &made), -EBADMSG);
    scratch_write_text(scratch_path(folder, "empty.csr"), "");
    assert_int_equal(sign_file(ca, "empty.csr", &door, &made), -EBADMSG);
    /* The last byte of the signature is another one. */
    must("openssl req -new -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout k.pem "
         "-subj /CN=x -outform DER -out d.der && n=$(stat -c %s d.der) && "
         "b=$(tail -c 1 d.der | od -An -tu1 | tr -d ' ') && "
         "(head -c $((n - 1)) d.der; printf \"\\\\$(printf %03o $((b ^ 1)))\") > e.der && "
         "openssl req -inform DER -in e.der -out bad.csr");
    assert_int_equal(sign_file(ca, "bad.csr", &door, &made), -EBADMSG);
    hub_ca_free(ca);
}

static void an_expelled_door_is_in_the_list(void **state)
{
    struct hub_ca *ca = open_ca();
    const struct iso_fleet_id door = iso_fleet_id_random();
    struct hub_door_certificate a, b;
    char *list = NULL;
    (void)state;

    must("openssl req -new -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout k.pem "
         "-subj /CN=x -out d.csr");
    assert_int_equal(sign_file(ca, "d.csr", &door, &a), 0);
    assert_int_equal(sign_file(ca, "d.csr", &door, &b), 0);
    assert_memory_not_equal(a.serial, b.serial, sizeof a.serial);
    scratch_write_text(scratch_path(folder, "a.pem"), a.pem);
    scratch_write_text(scratch_path(folder, "b.pem"), b.pem);
    const uint8_t serials[1][HUB_CA_SERIAL_BYTES] = {{0}};
    memcpy((void *)(uintptr_t)serials[0], a.serial, sizeof a.serial);
    assert_int_equal(hub_ca_revoke(ca, serials, 1, time(NULL), &list, NULL), 0);
    scratch_write_text(scratch_path(folder, "crl.pem"), list);
    must_not("openssl verify -crl_check -CAfile ca.pem -CRLfile crl.pem a.pem", "revoked");
    must("openssl verify -crl_check -CAfile ca.pem -CRLfile crl.pem b.pem");
    free(list);
    /* A fleet without expelled doors has a list all the same. */
    assert_int_equal(hub_ca_revoke(ca, NULL, 0, time(NULL), &list, NULL), 0);
    scratch_write_text(scratch_path(folder, "crl.pem"), list);
    must("openssl verify -crl_check -CAfile ca.pem -CRLfile crl.pem a.pem");
    free(list);
    free(a.pem);
    free(b.pem);
    hub_ca_free(ca);
}

static void the_hubs_own_certificates_renew_themselves(void **state)
{
    static const char *const hosts[] = {"hub.example.org", "192.0.2.7", "::1", "other.example"};
    struct hub_ca *ca = open_ca();
    struct hub_pair first, again;
    const int64_t now_s = time(NULL);
    (void)state;

    assert_int_equal(hub_pair_open(ca, folder, HUB_PAIR_HTTPS, hosts, 3, now_s, &first, NULL), 0);
    assert_true(first.is_new);
    must("openssl verify -x509_strict -purpose sslserver -verify_hostname hub.example.org -CAfile "
         "ca.pem https.pem");
    must("openssl verify -purpose sslserver -verify_ip 192.0.2.7 -CAfile ca.pem https.pem");
    must("openssl verify -purpose sslserver -verify_ip ::1 -CAfile ca.pem https.pem");
    must_not("openssl verify -verify_hostname other.example -CAfile ca.pem https.pem", "mismatch");
    assert_non_null(strstr(first.chain, hub_ca_pem(ca)));
    assert_int_equal(hub_pair_open(ca, folder, HUB_PAIR_HTTPS, hosts, 3, now_s, &again, NULL), 0);
    assert_false(again.is_new);
    assert_string_equal(first.chain, again.chain);
    hub_pair_free(&again);
    /* Another name is wanted. */
    assert_int_equal(hub_pair_open(ca, folder, HUB_PAIR_HTTPS, hosts, 4, now_s, &again, NULL), 0);
    assert_true(again.is_new);
    hub_pair_free(&again);
    /* Its end is near. */
    assert_int_equal(
        hub_pair_open(ca, folder, HUB_PAIR_HTTPS, hosts, 4,
                      now_s + (HUB_PAIR_DAYS - HUB_PAIR_RENEW_DAYS) * INT64_C(86400) - 3600, &again,
                      NULL),
        0);
    assert_false(again.is_new);
    hub_pair_free(&again);
    assert_int_equal(
        hub_pair_open(ca, folder, HUB_PAIR_HTTPS, hosts, 4,
                      now_s + (HUB_PAIR_DAYS - HUB_PAIR_RENEW_DAYS) * INT64_C(86400) + 3600, &again,
                      NULL),
        0);
    assert_true(again.is_new);
    hub_pair_free(&again);
    hub_pair_free(&first);
    hub_ca_free(ca);
}

static void the_client_of_the_hub_is_no_server(void **state)
{
    struct hub_ca *ca = open_ca();
    struct hub_pair pair;
    struct stat status;
    (void)state;

    assert_int_equal(hub_pair_open(ca, folder, HUB_PAIR_CLIENT, NULL, 0, time(NULL), &pair, NULL),
                     0);
    must("openssl verify -x509_strict -purpose sslclient -CAfile ca.pem hub-client.pem");
    must_not("openssl verify -purpose sslserver -CAfile ca.pem hub-client.pem", "purpose");
    assert_int_equal(stat(scratch_path(folder, "hub-client-key.pem"), &status), 0);
    assert_int_equal(status.st_mode & 0777, 0600);
    hub_pair_free(&pair);
    hub_ca_free(ca);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_authority_is_made_once, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(a_half_or_foreign_authority_is_refused, setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(a_door_gets_its_own_name_and_nothing_more, setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(a_bad_request_is_refused, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(an_expelled_door_is_in_the_list, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(the_hubs_own_certificates_renew_themselves, setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(the_client_of_the_hub_is_no_server, setup,
                                        scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
