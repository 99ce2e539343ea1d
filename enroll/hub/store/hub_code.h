/* One-time codes: 160 random bits in base32, of which the database has only the digest. Internal to
 * the store. */
#ifndef ISO_ENROLL_HUB_STORE_HUB_CODE_H
#define ISO_ENROLL_HUB_STORE_HUB_CODE_H

#include "enroll/hub/store/hub_door.h"

void hub__code_make(char code[HUB_CODE_SIZE], uint8_t digest[ISO_FLEET_DIGEST_BYTES]);

/* The digest of a code that somebody has typed: small letters are the same as capital ones. -EINVAL
 * it has another length or other characters. */
int hub__code_digest(const char *code, uint8_t digest[ISO_FLEET_DIGEST_BYTES])
    __attribute__((warn_unused_result));

#endif
