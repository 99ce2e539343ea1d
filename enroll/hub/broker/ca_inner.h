/* The authority, and steps that several files need. Internal to enroll/hub/broker. */
#ifndef HUB_BROKER_CA_INNER_H
#define HUB_BROKER_CA_INNER_H

#include <gnutls/abstract.h>
#include <gnutls/gnutls.h>
#include <gnutls/x509.h>

#include "enroll/hub/broker/hub_ca.h"

struct hub_ca {
    gnutls_x509_privkey_t key;
    gnutls_x509_crt_t certificate;
    char *pem;
    uint8_t digest[HUB_CA_DIGEST_BYTES];
    int64_t ends_s;
};

enum { HUB_PEM_MOST = 64 << 10 };

/* Writes the fault of GnuTLS for `what` and returns -EBADMSG. */
int hub__tls_fault(const char *what, int error, struct iso_fault *fault);

/* "FOLDER/NAME". -ENAMETOOLONG. */
int hub__path(char *path, size_t size, const char *folder, const char *name,
              struct iso_fault *fault) __attribute__((warn_unused_result));

/* A new P-256 key; the error of GnuTLS. */
int hub__key_make(gnutls_x509_privkey_t *key) __attribute__((warn_unused_result));

/* Sets version, a random serial number, the time from 1970 (a door's clock may not be set) to
 * `ends_s`, and the common name. The error of GnuTLS. */
int hub__describe(gnutls_x509_crt_t certificate, const char *name, int64_t ends_s,
                  uint8_t serial[HUB_CA_SERIAL_BYTES]) __attribute__((warn_unused_result));

/* Sets the key identifiers and signs. The error of GnuTLS. */
int hub__sign(const struct hub_ca *ca, gnutls_x509_crt_t certificate)
    __attribute__((warn_unused_result));

/* Writes a key or a certificate as PEM with mode 0600. */
int hub__key_store(const char *path, gnutls_x509_privkey_t key, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int hub__text_store(const char *path, const char *text, size_t size, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The PEM text of a certificate, which the caller frees with free(). The error of GnuTLS. */
int hub__pem_of(gnutls_x509_crt_t certificate, char **pem) __attribute__((warn_unused_result));

#endif
