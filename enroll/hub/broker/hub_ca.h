/* The certificate authority of a hub: one P-256 key that lives as long as the fleet. It signs the
 * certificates of the hub's HTTPS server and of its broker, and one certificate for each door.
 * Doors learn its digest from their join address (the parameter "ca"), so nobody else can be the
 * hub. All hub processes of a fleet have the same authority: an administrator copies the folder. */
#ifndef HUB_BROKER_HUB_CA_H
#define HUB_BROKER_HUB_CA_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "firmware/fleet/message/fleet_id.h"

enum {
    HUB_CA_DIGEST_BYTES = 32,
    HUB_CA_SERIAL_BYTES = 16,
    HUB_CA_DAYS = 3650,  /* of the authority */
    HUB_DOOR_DAYS = 90,  /* of a door's certificate; the door renews it */
    HUB_CSR_MOST = 4096, /* bytes of a request */
};

struct hub_ca;

/* Reads `folder`/ca-key.pem and `folder`/ca.pem, or makes both (mode 0600) if neither exists. The
 * caller frees *out. -EBADMSG a file is damaged, or the key belongs to another certificate; -ENOENT
 * one of the two is missing; errors of the disk. */
int hub_ca_open(const char *folder, struct hub_ca **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Wipes the key. NULL is accepted. */
void hub_ca_free(struct hub_ca *ca);

/* The certificate as PEM, and the SHA-256 of its DER form. Both live as long as the authority. */
const char *hub_ca_pem(const struct hub_ca *ca);
const uint8_t *hub_ca_digest(const struct hub_ca *ca);

/* A certificate of a door. The owner frees `pem` with free(). */
struct hub_door_certificate {
    char *pem;
    uint8_t serial[HUB_CA_SERIAL_BYTES];
    uint8_t key[HUB_CA_DIGEST_BYTES]; /* SHA-256 of the public key (SubjectPublicKeyInfo) */
    int64_t ends_s;                   /* since 1970 */
};

/* Signs the key of a request (PKCS #10, PEM). Everything else that the request says is ignored: the
 * name becomes the door's id, and the certificate is good for a TLS client alone. -EBADMSG the
 * request is damaged or not signed by its own key, -EKEYREJECTED its key is not ECDSA on P-256. */
int hub_ca_sign_door(const struct hub_ca *ca, const char *csr, size_t size,
                     const struct iso_fleet_id *door, int64_t now_s,
                     struct hub_door_certificate *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The checks of hub_ca_sign_door alone, for a caller who has still to find out whose request it is.
 * `key` receives the digest of the key, which its owner has proven to have. */
int hub_ca_check_request(const char *csr, size_t size, uint8_t key[HUB_CA_DIGEST_BYTES],
                         struct iso_fault *fault) __attribute__((warn_unused_result));

/* The list of the certificates that are not accepted any more, as PEM. It has no end, since a
 * broker with an expired list refuses every door. The caller frees *pem with free(). */
int hub_ca_revoke(const struct hub_ca *ca, const uint8_t (*serials)[HUB_CA_SERIAL_BYTES], size_t n,
                  int64_t now_s, char **pem, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
