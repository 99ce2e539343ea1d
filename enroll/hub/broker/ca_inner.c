#include "enroll/hub/broker/ca_inner.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "drivers/file/data_file.h"

int hub__tls_fault(const char *what, int error, struct iso_fault *fault)
{
    return iso_fault_set(fault, error == GNUTLS_E_MEMORY_ERROR ? -ENOMEM : -EBADMSG, "%s: %s", what,
                         gnutls_strerror(error));
}

int hub__path(char *path, size_t size, const char *folder, const char *name,
              struct iso_fault *fault)
{
    if (snprintf(path, size, "%s/%s", folder, name) >= (int)size) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%.64s...: the path is too long", folder);
    }
    return 0;
}

int hub__key_make(gnutls_x509_privkey_t *key)
{
    const int r = gnutls_x509_privkey_init(key);

    return r < 0 ? r
                 : gnutls_x509_privkey_generate(
                       *key, GNUTLS_PK_ECDSA, GNUTLS_CURVE_TO_BITS(GNUTLS_ECC_CURVE_SECP256R1), 0);
}

int hub__describe(gnutls_x509_crt_t certificate, const char *name, int64_t ends_s,
                  uint8_t serial[HUB_CA_SERIAL_BYTES])
{
    randombytes_buf(serial, HUB_CA_SERIAL_BYTES);
    /* A serial number is positive, and its first byte is not zero, so that its length is known. */
    serial[0] = (uint8_t)((serial[0] & 0x3f) | 0x40);
    int r = gnutls_x509_crt_set_version(certificate, 3);
    r = r < 0 ? r : gnutls_x509_crt_set_serial(certificate, serial, HUB_CA_SERIAL_BYTES);
    r = r < 0 ? r : gnutls_x509_crt_set_activation_time(certificate, 0);
    r = r < 0 ? r : gnutls_x509_crt_set_expiration_time(certificate, (time_t)ends_s);
    return r < 0 ? r
                 : gnutls_x509_crt_set_dn_by_oid(certificate, GNUTLS_OID_X520_COMMON_NAME, 0, name,
                                                 (unsigned)strlen(name));
}

int hub__sign(const struct hub_ca *ca, gnutls_x509_crt_t certificate)
{
    uint8_t id[64];
    size_t size = sizeof id;
    int r = gnutls_x509_crt_set_basic_constraints(certificate, 0, -1);

    r = r < 0 ? r : gnutls_x509_crt_set_key_usage(certificate, GNUTLS_KEY_DIGITAL_SIGNATURE);
    r = r < 0 ? r : gnutls_x509_crt_get_subject_key_id(ca->certificate, id, &size, NULL);
    r = r < 0 ? r : gnutls_x509_crt_set_authority_key_id(certificate, id, size);
    return r < 0
               ? r
               : gnutls_x509_crt_sign2(certificate, ca->certificate, ca->key, GNUTLS_DIG_SHA256, 0);
}

int hub__text_store(const char *path, const char *text, size_t size, struct iso_fault *fault)
{
    return iso_data_file_replace(path, text, size, fault);
}

int hub__key_store(const char *path, gnutls_x509_privkey_t key, struct iso_fault *fault)
{
    gnutls_datum_t pem = {NULL, 0};
    int r = gnutls_x509_privkey_export2(key, GNUTLS_X509_FMT_PEM, &pem);

    r = r < 0 ? hub__tls_fault(path, r, fault)
              : iso_data_file_replace(path, pem.data, pem.size, fault);
    if (pem.data) {
        sodium_memzero(pem.data, pem.size);
        gnutls_free(pem.data);
    }
    return r;
}

int hub__pem_of(gnutls_x509_crt_t certificate, char **pem)
{
    gnutls_datum_t text = {NULL, 0};
    const int r = gnutls_x509_crt_export2(certificate, GNUTLS_X509_FMT_PEM, &text);

    if (r < 0) {
        return r;
    }
    char *copy = strndup((const char *)text.data, text.size);
    gnutls_free(text.data);
    if (!copy) {
        return GNUTLS_E_MEMORY_ERROR;
    }
    *pem = copy;
    return 0;
}
