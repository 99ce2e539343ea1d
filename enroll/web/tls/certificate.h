/* The key and the certificate of the web server. At the first start the server makes an ECDSA key
 * on P-256 and a certificate that it signs itself; whoever has a certificate of an authority puts
 * both files into the same place. PEM. The key is readable for the service alone. */
#ifndef WEB_TLS_CERTIFICATE_H
#define WEB_TLS_CERTIFICATE_H

#include <stdint.h>

#include "core/base/fault.h"

enum {
    WEB_FINGERPRINT_SIZE = 32 * 3, /* "AB:CD:...": SHA-256 with the NUL */
    WEB_CERTIFICATE_VALID_DAYS = 3650,
};

struct web_certificate {
    char *key, *chain; /* PEM texts */
    char fingerprint[WEB_FINGERPRINT_SIZE];
    int64_t ends_s; /* seconds since 1970 */
};

/* Reads `folder`/key.pem and `folder`/certificate.pem, or makes both if neither exists; the names
 * of the certificate are then those of this machine. The caller frees *out with
 * web_certificate_free. Returns 0, or a negative errno with a fault: -EBADMSG a file is damaged, or
 * the key belongs to another certificate. */
int web_certificate_open(const char *folder, struct web_certificate *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads the fingerprint of the certificate alone, for which the key is not needed. -ENOENT: the
 * server has not been started yet. */
int web_certificate_fingerprint(const char *folder, char fingerprint[WEB_FINGERPRINT_SIZE],
                                struct iso_fault *fault) __attribute__((warn_unused_result));

/* Wipes and frees the texts. */
void web_certificate_free(struct web_certificate *certificate);

#endif
