#include "enroll/hub/broker/hub_ca.h"

#include <errno.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "drivers/file/file.h"
#include "enroll/hub/broker/ca_inner.h"

static const char key_name[] = "ca-key.pem", certificate_name[] = "ca.pem";

/* ---- making ---- */

static int describe_authority(gnutls_x509_crt_t certificate, gnutls_x509_privkey_t key,
                              int64_t ends_s)
{
    uint8_t serial[HUB_CA_SERIAL_BYTES], id[20];
    size_t size = sizeof id;
    int r = hub__describe(certificate, "Isotherm hub", ends_s, serial);

    r = r < 0 ? r : gnutls_x509_crt_set_key(certificate, key);
    r = r < 0 ? r : gnutls_x509_crt_set_basic_constraints(certificate, 1, 0);
    r = r < 0 ? r
              : gnutls_x509_crt_set_key_usage(certificate,
                                              GNUTLS_KEY_KEY_CERT_SIGN | GNUTLS_KEY_CRL_SIGN);
    r = r < 0 ? r : gnutls_x509_crt_get_key_id(certificate, GNUTLS_KEYID_USE_SHA1, id, &size);
    r = r < 0 ? r : gnutls_x509_crt_set_subject_key_id(certificate, id, size);
    return r < 0 ? r : gnutls_x509_crt_sign2(certificate, certificate, key, GNUTLS_DIG_SHA256, 0);
}

/* Writes the key first. A key without a certificate is an error at the next start, because whoever
 * restores a backup must not get another authority unnoticed. */
static int store(const char *key_path, const char *path, gnutls_x509_privkey_t key,
                 gnutls_x509_crt_t certificate, struct iso_fault *fault)
{
    char *pem = NULL;
    int r = hub__pem_of(certificate, &pem);

    r = r < 0 ? hub__tls_fault(path, r, fault) : hub__key_store(key_path, key, fault);
    r = r < 0 ? r : hub__text_store(path, pem, strlen(pem), fault);
    free(pem);
    return r;
}

static int make(const char *key_path, const char *path, struct iso_fault *fault)
{
    gnutls_x509_privkey_t key = NULL;
    gnutls_x509_crt_t certificate = NULL;
    int r = hub__key_make(&key);

    r = r < 0 ? r : gnutls_x509_crt_init(&certificate);
    r = r < 0 ? r : describe_authority(certificate, key, time(NULL) + HUB_CA_DAYS * INT64_C(86400));
    r = r < 0 ? hub__tls_fault(path, r, fault) : store(key_path, path, key, certificate, fault);
    gnutls_x509_crt_deinit(certificate);
    gnutls_x509_privkey_deinit(key);
    return r;
}

/* ---- reading ---- */

static int import_key(struct hub_ca *ca, const char *path, struct iso_fault *fault)
{
    char *text = NULL;
    size_t size = 0;
    int r = iso_file_read(path, HUB_PEM_MOST, &text, &size, fault);

    if (r < 0) {
        return r;
    }
    const gnutls_datum_t pem = {(unsigned char *)text, (unsigned)size};
    r = gnutls_x509_privkey_init(&ca->key);
    r = r < 0 ? r : gnutls_x509_privkey_import(ca->key, &pem, GNUTLS_X509_FMT_PEM);
    sodium_memzero(text, size);
    free(text);
    return r < 0 ? hub__tls_fault(path, r, fault) : 0;
}

static int import_certificate(struct hub_ca *ca, const char *path, struct iso_fault *fault)
{
    size_t size = 0, digest_size = sizeof ca->digest;
    int r = iso_file_read(path, HUB_PEM_MOST, &ca->pem, &size, fault);

    if (r < 0) {
        return r;
    }
    const gnutls_datum_t pem = {(unsigned char *)ca->pem, (unsigned)size};
    r = gnutls_x509_crt_init(&ca->certificate);
    r = r < 0 ? r : gnutls_x509_crt_import(ca->certificate, &pem, GNUTLS_X509_FMT_PEM);
    r = r < 0 ? r
              : gnutls_x509_crt_get_fingerprint(ca->certificate, GNUTLS_DIG_SHA256, ca->digest,
                                                &digest_size);
    if (r < 0) {
        return hub__tls_fault(path, r, fault);
    }
    ca->ends_s = gnutls_x509_crt_get_expiration_time(ca->certificate);
    return 0;
}

/* Whether key and certificate belong together. */
static int check_pair(const struct hub_ca *ca, const char *path, struct iso_fault *fault)
{
    uint8_t of_key[32], of_certificate[32];
    size_t n = sizeof of_key, m = sizeof of_certificate;
    int r = gnutls_x509_privkey_get_key_id(ca->key, GNUTLS_KEYID_USE_SHA256, of_key, &n);

    r = r < 0 ? r
              : gnutls_x509_crt_get_key_id(ca->certificate, GNUTLS_KEYID_USE_SHA256, of_certificate,
                                           &m);
    if (r < 0) {
        return hub__tls_fault(path, r, fault);
    }
    if (n != m || memcmp(of_key, of_certificate, n) != 0) {
        return iso_fault_set(fault, -EBADMSG, "%s: belongs to another key", path);
    }
    return 0;
}

int hub_ca_open(const char *folder, struct hub_ca **out, struct iso_fault *fault)
{
    char key_path[PATH_MAX], path[PATH_MAX];
    int r = hub__path(key_path, sizeof key_path, folder, key_name, fault);

    r = r < 0 ? r : hub__path(path, sizeof path, folder, certificate_name, fault);
    if (r == 0 && access(path, F_OK) && errno == ENOENT && access(key_path, F_OK) &&
        errno == ENOENT) {
        r = make(key_path, path, fault);
    }
    struct hub_ca *ca = r < 0 ? NULL : calloc(1, sizeof *ca);
    if (!ca) {
        return r < 0 ? r : iso_fault_set(fault, -ENOMEM, "out of memory for the authority");
    }
    r = import_key(ca, key_path, fault);
    r = r < 0 ? r : import_certificate(ca, path, fault);
    r = r < 0 ? r : check_pair(ca, path, fault);
    if (r < 0) {
        hub_ca_free(ca);
        return r;
    }
    *out = ca;
    return 0;
}

void hub_ca_free(struct hub_ca *ca)
{
    if (!ca) {
        return;
    }
    gnutls_x509_privkey_deinit(ca->key); /* wipes it */
    gnutls_x509_crt_deinit(ca->certificate);
    free(ca->pem);
    free(ca);
}

const char *hub_ca_pem(const struct hub_ca *ca)
{
    return ca->pem;
}

const uint8_t *hub_ca_digest(const struct hub_ca *ca)
{
    return ca->digest;
}
