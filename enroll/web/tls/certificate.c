#include "enroll/web/tls/certificate.h"

#include <errno.h>
#include <gnutls/gnutls.h>
#include <gnutls/x509.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "drivers/file/file.h"
#include "enroll/web/account/state_file.h"

enum { PEM_MOST_BYTES = 64 << 10 };

static const char key_name[] = "key.pem";
static const char chain_name[] = "certificate.pem";

static void path_of(char path[PATH_MAX], const char *folder, const char *name)
{
    (void)snprintf(path, PATH_MAX, "%s/%s", folder, name);
}

static int fault_of(const char *path, int error, struct iso_fault *fault)
{
    return iso_fault_set(fault, -EBADMSG, "%s: %s", path, gnutls_strerror(error));
}

/* ---- making ---- */

static int describe(gnutls_x509_crt_t certificate, gnutls_x509_privkey_t key)
{
    char host[HOST_NAME_MAX + 1] = "isotherm";
    uint8_t serial[16];
    const time_t now = time(NULL);
    (void)gethostname(host, sizeof host - 1);
    randombytes_buf(serial, sizeof serial);
    serial[0] &= 0x7f; /* a serial number is positive */
    int r = gnutls_x509_crt_set_version(certificate, 3);
    r = r < 0 ? r : gnutls_x509_crt_set_serial(certificate, serial, sizeof serial);
    /* A clock that is not set yet must not make a certificate that begins in the future. */
    r = r < 0 ? r : gnutls_x509_crt_set_activation_time(certificate, 0);
    r = r < 0 ? r
              : gnutls_x509_crt_set_expiration_time(certificate,
                                                    now + WEB_CERTIFICATE_VALID_DAYS * 86400L);
    r = r < 0 ? r
              : gnutls_x509_crt_set_dn_by_oid(certificate, GNUTLS_OID_X520_COMMON_NAME, 0, host,
                                              (unsigned)strlen(host));
    r = r < 0 ? r
              : gnutls_x509_crt_set_subject_alt_name(certificate, GNUTLS_SAN_DNSNAME, host,
                                                     (unsigned)strlen(host), GNUTLS_FSAN_APPEND);
    r = r < 0 ? r : gnutls_x509_crt_set_key_usage(certificate, GNUTLS_KEY_DIGITAL_SIGNATURE);
    r = r < 0 ? r : gnutls_x509_crt_set_key_purpose_oid(certificate, GNUTLS_KP_TLS_WWW_SERVER, 0);
    r = r < 0 ? r : gnutls_x509_crt_set_basic_constraints(certificate, 0, -1);
    r = r < 0 ? r : gnutls_x509_crt_set_key(certificate, key);
    return r < 0 ? r : gnutls_x509_crt_sign2(certificate, certificate, key, GNUTLS_DIG_SHA256, 0);
}

/* Writes the key first: a key without a certificate is replaced at the next start. */
static int store(const char *folder, gnutls_x509_crt_t certificate, gnutls_x509_privkey_t key,
                 struct iso_fault *fault)
{
    gnutls_datum_t pem = {NULL, 0};
    char path[PATH_MAX];
    path_of(path, folder, key_name);
    int r = gnutls_x509_privkey_export2(key, GNUTLS_X509_FMT_PEM, &pem);
    r = r < 0 ? fault_of(path, r, fault) : web_state_file_write(path, pem.data, pem.size, fault);
    if (pem.data) {
        sodium_memzero(pem.data, pem.size);
        gnutls_free(pem.data);
    }
    if (r < 0) {
        return r;
    }
    path_of(path, folder, chain_name);
    pem = (gnutls_datum_t){NULL, 0};
    r = gnutls_x509_crt_export2(certificate, GNUTLS_X509_FMT_PEM, &pem);
    r = r < 0 ? fault_of(path, r, fault) : web_state_file_write(path, pem.data, pem.size, fault);
    gnutls_free(pem.data);
    return r;
}

static int make(const char *folder, struct iso_fault *fault)
{
    gnutls_x509_privkey_t key = NULL;
    gnutls_x509_crt_t certificate = NULL;
    int r = gnutls_x509_privkey_init(&key);
    r = r < 0 ? r : gnutls_x509_crt_init(&certificate);
    r = r < 0 ? r
              : gnutls_x509_privkey_generate(key, GNUTLS_PK_ECDSA,
                                             GNUTLS_CURVE_TO_BITS(GNUTLS_ECC_CURVE_SECP256R1), 0);
    r = r < 0 ? r : describe(certificate, key);
    r = r < 0 ? fault_of(folder, r, fault) : store(folder, certificate, key, fault);
    gnutls_x509_crt_deinit(certificate);
    gnutls_x509_privkey_deinit(key);
    return r;
}

/* ---- reading ---- */

/* The first certificate of a chain. GnuTLS reads a PEM text with several from its beginning. */
static int examine(const char *path, const char *pem, struct web_certificate *out,
                   struct iso_fault *fault)
{
    const gnutls_datum_t text = {(unsigned char *)(uintptr_t)pem, (unsigned)strlen(pem)};
    gnutls_x509_crt_t certificate = NULL;
    uint8_t hash[32];
    size_t size = sizeof hash;
    int r = gnutls_x509_crt_init(&certificate);
    r = r < 0 ? r : gnutls_x509_crt_import(certificate, &text, GNUTLS_X509_FMT_PEM);
    r = r < 0 ? r : gnutls_x509_crt_get_fingerprint(certificate, GNUTLS_DIG_SHA256, hash, &size);
    if (r >= 0) {
        for (size_t i = 0; i < sizeof hash; i++) {
            (void)snprintf(out->fingerprint + 3 * i, 4, i + 1 < sizeof hash ? "%02X:" : "%02X",
                           hash[i]);
        }
        out->ends_s = gnutls_x509_crt_get_expiration_time(certificate);
    }
    gnutls_x509_crt_deinit(certificate);
    return r < 0 ? fault_of(path, r, fault) : 0;
}

static int check_pair(const char *path, const struct web_certificate *pair, struct iso_fault *fault)
{
    const gnutls_datum_t chain = {(unsigned char *)pair->chain, (unsigned)strlen(pair->chain)};
    const gnutls_datum_t key = {(unsigned char *)pair->key, (unsigned)strlen(pair->key)};
    gnutls_certificate_credentials_t credentials = NULL;
    int r = gnutls_certificate_allocate_credentials(&credentials);
    if (r >= 0) {
        r = gnutls_certificate_set_x509_key_mem(credentials, &chain, &key, GNUTLS_X509_FMT_PEM);
        gnutls_certificate_free_credentials(credentials);
    }
    return r < 0 ? fault_of(path, r, fault) : 0;
}

static int read_pem(const char *folder, const char *name, char **out, struct iso_fault *fault)
{
    char path[PATH_MAX];
    size_t size = 0;
    path_of(path, folder, name);
    return iso_file_read(path, PEM_MOST_BYTES, out, &size, fault);
}

int web_certificate_open(const char *folder, struct web_certificate *out, struct iso_fault *fault)
{
    struct web_certificate read = {.key = NULL};
    char path[PATH_MAX];
    path_of(path, folder, chain_name);
    if (access(path, F_OK) && errno == ENOENT) {
        const int made = make(folder, fault);
        if (made < 0) {
            return made;
        }
    }
    int r = read_pem(folder, chain_name, &read.chain, fault);
    r = r < 0 ? r : read_pem(folder, key_name, &read.key, fault);
    r = r < 0 ? r : examine(path, read.chain, &read, fault);
    r = r < 0 ? r : check_pair(path, &read, fault);
    if (r < 0) {
        web_certificate_free(&read);
        return r;
    }
    *out = read;
    return 0;
}

int web_certificate_fingerprint(const char *folder, char fingerprint[WEB_FINGERPRINT_SIZE],
                                struct iso_fault *fault)
{
    struct web_certificate read = {.key = NULL};
    char path[PATH_MAX];
    path_of(path, folder, chain_name);
    int r = read_pem(folder, chain_name, &read.chain, fault);
    r = r < 0 ? r : examine(path, read.chain, &read, fault);
    if (r == 0) {
        memcpy(fingerprint, read.fingerprint, WEB_FINGERPRINT_SIZE);
    }
    web_certificate_free(&read);
    return r;
}

void web_certificate_free(struct web_certificate *certificate)
{
    if (certificate->key) {
        sodium_memzero(certificate->key, strlen(certificate->key));
    }
    free(certificate->key);
    free(certificate->chain);
    *certificate = (struct web_certificate){.key = NULL};
}
