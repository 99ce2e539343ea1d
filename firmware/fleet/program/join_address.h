/* The one-time address with which a door joins a fleet, as `isotherm-hub door add` prints it:
 * isotherm://HOST:PORT/?ca=<64 hexadecimal digits>&code=<base32>. Pure. */
#ifndef ISO_FIRMWARE_FLEET_PROGRAM_JOIN_ADDRESS_H
#define ISO_FIRMWARE_FLEET_PROGRAM_JOIN_ADDRESS_H

#include <stdint.h>

#include "core/base/fault.h"

enum {
    LINK_HOST_SIZE = 256,
    LINK_URL_SIZE = LINK_HOST_SIZE + 16,
    LINK_CODE_SIZE = 129,
    LINK_DIGEST_BYTES = 32,
};

struct link_join_address {
    char url[LINK_URL_SIZE];       /* "https://HOST:PORT" */
    uint8_t ca[LINK_DIGEST_BYTES]; /* SHA-256 of the authority's certificate */
    char code[LINK_CODE_SIZE];     /* a secret, which the owner wipes */
};

/* -EINVAL: the text is no such address; the fault says what is wrong and does not repeat the code.
 */
int link_join_address_read(const char *text, struct link_join_address *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
