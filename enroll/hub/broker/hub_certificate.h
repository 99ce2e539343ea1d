/* Which certificates the hub has signed for which doors: the table door_certificate. It is needed
 * for the list of revoked certificates. The errors of enroll/hub/store/hub_store.h. */
#ifndef HUB_BROKER_HUB_CERTIFICATE_H
#define HUB_BROKER_HUB_CERTIFICATE_H

#include "enroll/hub/broker/hub_ca.h"
#include "enroll/hub/store/hub_store.h"

/* Remembers a certificate before it is handed out; those of the door that have ended are
 * forgotten. */
int hub_certificate_add(struct hub_store *store, const struct iso_fleet_id *door,
                        const struct hub_door_certificate *certificate, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The door that has had a certificate for this key; a door that is expelled has none. -ENOENT there
 * is none. */
int hub_certificate_owner(struct hub_store *store, const uint8_t key[HUB_CA_DIGEST_BYTES],
                          struct iso_fleet_id *door, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The serial numbers of the certificates of expelled doors that have not ended. The caller frees
 * *serials with free(). */
int hub_certificate_revoked(struct hub_store *store, uint8_t (**serials)[HUB_CA_SERIAL_BYTES],
                            size_t *n, struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
