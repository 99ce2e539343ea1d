/* The folder that configures mosquitto for a fleet:
 *
 *   mosquitto.conf   two listeners with TLS: for the doors and for the hub; both want a certificate
 *                    of the hub's authority, whose name is the user
 *   acl              what each user may read and write; who is not in it, nothing
 *   crl.pem          certificates of expelled doors
 *   ca.pem, broker.pem, broker-key.pem
 *   home-assistant.pem, home-assistant-key.pem, if they are wanted
 *
 * Files have mode 0640 and the group of the folder, so that a folder of the group mosquitto
 * (set-gid) is enough. Mosquitto reads acl, crl.pem and its certificate anew on SIGHUP. */
#ifndef HUB_BROKER_BROKER_CONFIG_H
#define HUB_BROKER_BROKER_CONFIG_H

#include <stdbool.h>

#include "enroll/hub/broker/broker_text.h"
#include "enroll/hub/broker/hub_ca.h"

enum { HUB_BROKER_PORT = 8883, HUB_BROKER_HUB_PORT = 8884 };

/* Writes all files that differ from what they should be. `hosts` are the names and addresses by
 * which doors and hub reach the broker. *changed says whether one was written. Errors of the
 * database, of the disk and of hub_pair_open(). */
int broker_config_write(struct hub_store *store, const struct hub_ca *ca,
                        const struct broker_places *places, const char *const *hosts, size_t n,
                        bool *changed, struct iso_fault *fault) __attribute__((warn_unused_result));

/* Whether a door has changed after the act *mark (hub_act.h), which becomes the newest act. Cheap.
 * An act that is committed after one with a higher number is overlooked. */
int broker_config_look(struct hub_store *store, int64_t *mark, bool *changed,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Writes acl and crl.pem alone, which follow the doors. */
int broker_config_follow(struct hub_store *store, const struct hub_ca *ca, const char *folder,
                         bool *changed, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
