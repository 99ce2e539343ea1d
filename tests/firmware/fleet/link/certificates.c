#include "tests/firmware/fleet/link/certificates.h"

#include <arpa/inet.h>
#include <gnutls/abstract.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

static gnutls_x509_privkey_t make_key(char pem[4096])
{
    gnutls_x509_privkey_t key;
    size_t size = 4096;

    assert_int_equal(gnutls_x509_privkey_init(&key), 0);
    assert_int_equal(gnutls_x509_privkey_generate(
                         key, GNUTLS_PK_ECDSA, GNUTLS_CURVE_TO_BITS(GNUTLS_ECC_CURVE_SECP256R1), 0),
                     0);
    assert_int_equal(gnutls_x509_privkey_export(key, GNUTLS_X509_FMT_PEM, pem, &size), 0);
    return key;
}

static gnutls_x509_crt_t begin(const char *name)
{
    static unsigned char serial[4] = {1};
    gnutls_x509_crt_t made;

    serial[3]++;
    assert_int_equal(gnutls_x509_crt_init(&made), 0);
    assert_int_equal(gnutls_x509_crt_set_version(made, 3), 0);
    assert_int_equal(gnutls_x509_crt_set_serial(made, serial, sizeof serial), 0);
    assert_int_equal(gnutls_x509_crt_set_activation_time(made, 0), 0);
    assert_int_equal(gnutls_x509_crt_set_expiration_time(made, time(NULL) + 90 * 86400), 0);
    assert_int_equal(gnutls_x509_crt_set_dn_by_oid(made, GNUTLS_OID_X520_COMMON_NAME, 0, name,
                                                   (unsigned)strlen(name)),
                     0);
    return made;
}

static void end(const struct authority *authority, gnutls_x509_crt_t made, char pem[4096])
{
    size_t size = 4096;

    assert_int_equal(
        gnutls_x509_crt_sign2(made, authority->certificate, authority->key, GNUTLS_DIG_SHA256, 0),
        0);
    assert_int_equal(gnutls_x509_crt_export(made, GNUTLS_X509_FMT_PEM, pem, &size), 0);
}

void authority_make(struct authority *authority)
{
    char unused[4096];
    size_t size = sizeof authority->digest;

    authority->key = make_key(unused);
    authority->certificate = begin("authority");
    assert_int_equal(gnutls_x509_crt_set_basic_constraints(authority->certificate, 1, 0), 0);
    assert_int_equal(
        gnutls_x509_crt_set_key_usage(authority->certificate, GNUTLS_KEY_KEY_CERT_SIGN), 0);
    assert_int_equal(gnutls_x509_crt_set_key(authority->certificate, authority->key), 0);
    end(authority, authority->certificate, authority->pem);
    assert_int_equal(gnutls_x509_crt_get_fingerprint(authority->certificate, GNUTLS_DIG_SHA256,
                                                     authority->digest, &size),
                     0);
}

void authority_free(struct authority *authority)
{
    gnutls_x509_crt_deinit(authority->certificate);
    gnutls_x509_privkey_deinit(authority->key);
}

void authority_server(const struct authority *authority, char key[4096], char chain[8192])
{
    gnutls_x509_privkey_t own = make_key(key);
    gnutls_x509_crt_t made = begin("hub");
    struct in_addr address = {.s_addr = htonl(INADDR_LOOPBACK)};

    assert_int_equal(gnutls_x509_crt_set_key(made, own), 0);
    assert_int_equal(gnutls_x509_crt_set_subject_alt_name(made, GNUTLS_SAN_IPADDRESS, &address,
                                                          sizeof address, GNUTLS_FSAN_SET),
                     0);
    assert_int_equal(gnutls_x509_crt_set_key_purpose_oid(made, GNUTLS_KP_TLS_WWW_SERVER, 0), 0);
    end(authority, made, chain);
    (void)strcat(chain, authority->pem);
    gnutls_x509_crt_deinit(made);
    gnutls_x509_privkey_deinit(own);
}

void authority_client(const struct authority *authority, const char *name, char key[4096],
                      char certificate[4096])
{
    gnutls_x509_privkey_t own = make_key(key);
    gnutls_x509_crt_t made = begin(name);

    assert_int_equal(gnutls_x509_crt_set_key(made, own), 0);
    assert_int_equal(gnutls_x509_crt_set_key_purpose_oid(made, GNUTLS_KP_TLS_WWW_CLIENT, 0), 0);
    end(authority, made, certificate);
    gnutls_x509_crt_deinit(made);
    gnutls_x509_privkey_deinit(own);
}

void authority_sign(const struct authority *authority, const char *csr, const char *name,
                    char certificate[4096])
{
    const gnutls_datum_t pem = {(unsigned char *)(uintptr_t)csr, (unsigned)strlen(csr)};
    gnutls_x509_crt_t made = begin(name);
    gnutls_x509_crq_t request;
    gnutls_pubkey_t key;

    assert_int_equal(gnutls_x509_crq_init(&request), 0);
    assert_int_equal(gnutls_x509_crq_import(request, &pem, GNUTLS_X509_FMT_PEM), 0);
    assert_int_equal(gnutls_x509_crq_verify(request, 0), 0);
    assert_int_equal(gnutls_pubkey_init(&key), 0);
    assert_int_equal(gnutls_pubkey_import_x509_crq(key, request, 0), 0);
    assert_int_equal(gnutls_x509_crt_set_pubkey(made, key), 0);
    assert_int_equal(gnutls_x509_crt_set_key_purpose_oid(made, GNUTLS_KP_TLS_WWW_CLIENT, 0), 0);
    end(authority, made, certificate);
    gnutls_pubkey_deinit(key);
    gnutls_x509_crq_deinit(request);
    gnutls_x509_crt_deinit(made);
}
