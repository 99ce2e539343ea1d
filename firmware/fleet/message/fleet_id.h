/* Numbers that name a zone, a door or a person everywhere in a fleet: 16 random bytes, written as a
 * UUID (RFC 9562, version 4). */
#ifndef ISO_FIRMWARE_FLEET_MESSAGE_FLEET_ID_H
#define ISO_FIRMWARE_FLEET_MESSAGE_FLEET_ID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { ISO_FLEET_ID_BYTES = 16, ISO_FLEET_ID_TEXT_SIZE = 37 };

struct iso_fleet_id {
    uint8_t bytes[ISO_FLEET_ID_BYTES];
};

/* Makes a random id. iso_fleet_start() (envelope.h) was called. */
struct iso_fleet_id iso_fleet_id_random(void);

/* The same id for the same bytes: the first half of their BLAKE2b digest, marked as a UUID of
 * version 8. */
struct iso_fleet_id iso_fleet_id_of(const void *bytes, size_t size);

bool iso_fleet_id_is_same(const struct iso_fleet_id *a, const struct iso_fleet_id *b);
bool iso_fleet_id_is_zero(const struct iso_fleet_id *id);

/* "0190b3f2-...": 36 characters, lower case. read: -EINVAL the text is no UUID of this form. */
const char *iso_fleet_id_text(const struct iso_fleet_id *id, char text[ISO_FLEET_ID_TEXT_SIZE]);
int iso_fleet_id_read(const char *text, struct iso_fleet_id *out)
    __attribute__((warn_unused_result));

#endif
