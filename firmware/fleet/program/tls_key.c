#include "firmware/fleet/program/tls_key.h"

#include <errno.h>
#include <gnutls/gnutls.h>
#include <gnutls/x509.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

static gnutls_datum_t datum_of(const char *text)
{
    return (gnutls_datum_t){(unsigned char *)(uintptr_t)text, (unsigned)strlen(text)};
}

/* Copies a text of GnuTLS, wipes it and frees it. */
static char *take(gnutls_datum_t *text)
{
    char *copy = text->data ? strndup((const char *)text->data, text->size) : NULL;

    if (text->data) {
        sodium_memzero(text->data, text->size);
    }
    gnutls_free(text->data);
    text->data = NULL;
    return copy;
}

static int finish(const char *what, int error, gnutls_datum_t *text, char **out,
                  struct iso_fault *fault)
{
    char *made = take(text);

    if (error < 0 || !made) {
        free(made);
        return error < 0 ? iso_fault_set(fault, -EBADMSG, "%s: %s", what, gnutls_strerror(error))
                         : iso_fault_set(fault, -ENOMEM, "%s: out of memory", what);
    }
    *out = made;
    return 0;
}

int link_tls_key_make(char **key, struct iso_fault *fault)
{
    gnutls_x509_privkey_t made = NULL;
    gnutls_datum_t text = {NULL, 0};
    int r = gnutls_x509_privkey_init(&made);

    r = r < 0 ? r
              : gnutls_x509_privkey_generate(made, GNUTLS_PK_ECDSA,
                                             GNUTLS_CURVE_TO_BITS(GNUTLS_ECC_CURVE_SECP256R1), 0);
    r = r < 0 ? r : gnutls_x509_privkey_export2(made, GNUTLS_X509_FMT_PEM, &text);
    gnutls_x509_privkey_deinit(made);
    return finish("the key of the door's certificate", r, &text, key, fault);
}

static int import_key(const char *text, gnutls_x509_privkey_t *out)
{
    const gnutls_datum_t pem = datum_of(text);
    int r = gnutls_x509_privkey_init(out);

    return r < 0 ? r : gnutls_x509_privkey_import(*out, &pem, GNUTLS_X509_FMT_PEM);
}

int link_tls_request(const char *key, const char *name, char **csr, struct iso_fault *fault)
{
    gnutls_x509_privkey_t own = NULL;
    gnutls_x509_crq_t request = NULL;
    gnutls_datum_t text = {NULL, 0};
    int r = import_key(key, &own);

    r = r < 0 ? r : gnutls_x509_crq_init(&request);
    r = r < 0 ? r : gnutls_x509_crq_set_version(request, 1);
    r = r < 0 ? r
              : gnutls_x509_crq_set_dn_by_oid(request, GNUTLS_OID_X520_COMMON_NAME, 0, name,
                                              (unsigned)strlen(name));
    r = r < 0 ? r : gnutls_x509_crq_set_key(request, own);
    r = r < 0 ? r : gnutls_x509_crq_sign2(request, own, GNUTLS_DIG_SHA256, 0);
    r = r < 0 ? r : gnutls_x509_crq_export2(request, GNUTLS_X509_FMT_PEM, &text);
    gnutls_x509_crq_deinit(request);
    gnutls_x509_privkey_deinit(own);
    return finish("the request for the door's certificate", r, &text, csr, fault);
}

int link_tls_examine(const char *certificate, uint8_t digest[32], int64_t *ends_s,
                     struct iso_fault *fault)
{
    const gnutls_datum_t pem = datum_of(certificate);
    gnutls_x509_crt_t read = NULL;
    uint8_t hash[32];
    size_t size = sizeof hash;
    int r = gnutls_x509_crt_init(&read);

    r = r < 0 ? r : gnutls_x509_crt_import(read, &pem, GNUTLS_X509_FMT_PEM);
    r = r < 0 ? r : gnutls_x509_crt_get_fingerprint(read, GNUTLS_DIG_SHA256, hash, &size);
    if (r >= 0) {
        memcpy(digest, hash, sizeof hash);
        *ends_s = gnutls_x509_crt_get_expiration_time(read);
    }
    gnutls_x509_crt_deinit(read);
    return r < 0 ? iso_fault_set(fault, -EBADMSG, "a certificate: %s", gnutls_strerror(r)) : 0;
}

bool link_tls_fits(const char *certificate, const char *key)
{
    const gnutls_datum_t chain = datum_of(certificate), own = datum_of(key);
    gnutls_certificate_credentials_t credentials = NULL;
    int r = gnutls_certificate_allocate_credentials(&credentials);

    if (r >= 0) {
        r = gnutls_certificate_set_x509_key_mem(credentials, &chain, &own, GNUTLS_X509_FMT_PEM);
        gnutls_certificate_free_credentials(credentials);
    }
    return r >= 0;
}
