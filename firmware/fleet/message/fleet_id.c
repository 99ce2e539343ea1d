#include "firmware/fleet/message/fleet_id.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

static void mark(struct iso_fleet_id *id, unsigned version)
{
    id->bytes[6] = (uint8_t)((id->bytes[6] & 0x0f) | version << 4);
    id->bytes[8] = (uint8_t)((id->bytes[8] & 0x3f) | 0x80);
}

struct iso_fleet_id iso_fleet_id_random(void)
{
    struct iso_fleet_id id;
    randombytes_buf(id.bytes, sizeof id.bytes);
    mark(&id, 4);
    return id;
}

struct iso_fleet_id iso_fleet_id_of(const void *bytes, size_t size)
{
    struct iso_fleet_id id;
    (void)crypto_generichash(id.bytes, sizeof id.bytes, bytes, size, NULL, 0);
    mark(&id, 8);
    return id;
}

bool iso_fleet_id_is_same(const struct iso_fleet_id *a, const struct iso_fleet_id *b)
{
    return memcmp(a->bytes, b->bytes, sizeof a->bytes) == 0;
}

bool iso_fleet_id_is_zero(const struct iso_fleet_id *id)
{
    static const struct iso_fleet_id zero;
    return iso_fleet_id_is_same(id, &zero);
}

const char *iso_fleet_id_text(const struct iso_fleet_id *id, char text[ISO_FLEET_ID_TEXT_SIZE])
{
    const uint8_t *b = id->bytes;
    (void)snprintf(text, ISO_FLEET_ID_TEXT_SIZE,
                   "%02x%02x%02x%02x-%02x%02x-%02x%02x-%02x%02x-%02x%02x%02x%02x%02x%02x", b[0],
                   b[1], b[2], b[3], b[4], b[5], b[6], b[7], b[8], b[9], b[10], b[11], b[12], b[13],
                   b[14], b[15]);
    return text;
}

int iso_fleet_id_read(const char *text, struct iso_fleet_id *out)
{
    struct iso_fleet_id id;
    size_t size = 0;
    if (strlen(text) != ISO_FLEET_ID_TEXT_SIZE - 1 || text[8] != '-' || text[13] != '-' ||
        text[18] != '-' || text[23] != '-') {
        return -EINVAL;
    }
    if (sodium_hex2bin(id.bytes, sizeof id.bytes, text, strlen(text), "-", &size, NULL) ||
        size != sizeof id.bytes) {
        return -EINVAL;
    }
    *out = id;
    return 0;
}
