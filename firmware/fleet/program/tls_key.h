/* The key of a door's TLS certificate (ECDSA on P-256), requests for certificates, and their
 * digests. All texts are PEM. */
#ifndef ISO_FIRMWARE_FLEET_PROGRAM_TLS_KEY_H
#define ISO_FIRMWARE_FLEET_PROGRAM_TLS_KEY_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"

/* Makes a key. The caller wipes the text and frees it with free(). -EIO, -ENOMEM. */
int link_tls_key_make(char **key, struct iso_fault *fault) __attribute__((warn_unused_result));

/* Makes a request for a certificate of this key, signed by it. `name` is the common name; the hub
 * sets another one. The caller frees *csr. -EBADMSG the key is none, -ENOMEM. */
int link_tls_request(const char *key, const char *name, char **csr, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The SHA-256 of a certificate, and when it ends (seconds since 1970). -EBADMSG it is none. */
int link_tls_examine(const char *certificate, uint8_t digest[32], int64_t *ends_s,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Whether a certificate is for this key. */
bool link_tls_fits(const char *certificate, const char *key);

#endif
