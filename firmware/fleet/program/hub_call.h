/* Single requests to the hub, for which the caller waits. */
#ifndef ISO_FIRMWARE_FLEET_PROGRAM_HUB_CALL_H
#define ISO_FIRMWARE_FLEET_PROGRAM_HUB_CALL_H

#include <jansson.h>
#include <stdint.h>

#include "core/base/fault.h"

/* Asks the server at `url` for its certificates without trusting it, and finds the one with this
 * SHA-256. Nothing is sent to the server but the beginning of TLS. The caller frees *pem.
 * -EKEYREJECTED the server has no such certificate: it is not the hub; -ECONNREFUSED and others: it
 * cannot be reached. */
int link_hub_authority(const char *url, const uint8_t digest[32], char **pem,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* POSTs a JSON object to URL + PATH and waits for the JSON object of the reply, which the caller
 * unreferences. `ca_file` has the only trusted authority. -EACCES the hub refuses (the fault has
 * its words), -EBADMSG the reply is none; errors of link_http.h. */
int link_hub_post(const char *url, const char *path, const char *ca_file, const json_t *body,
                  json_t **reply, struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
