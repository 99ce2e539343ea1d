#include "firmware/fleet/message/wire.h"

#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"

void iso_fleet_bytes_free(struct iso_fleet_bytes *out)
{
    if (out->bytes) {
        sodium_memzero(out->bytes, out->capacity);
        free(out->bytes);
    }
    *out = (struct iso_fleet_bytes){.bytes = NULL};
}

static int grow(struct iso_fleet_bytes *out, size_t more)
{
    const size_t capacity = 2 * (out->size + more) + 64;
    uint8_t *grown = malloc(capacity);
    if (!grown) {
        return -ENOMEM;
    }
    if (out->bytes) {
        memcpy(grown, out->bytes, out->size);
        sodium_memzero(out->bytes, out->capacity);
        free(out->bytes);
    }
    out->bytes = grown;
    out->capacity = capacity;
    return 0;
}

uint8_t *iso_fleet_bytes_room(struct iso_fleet_bytes *out, size_t n)
{
    /* A buffer is made for no bytes, too: NULL must mean that memory is missing. */
    if (!out->error && (!out->bytes || n > out->capacity - out->size)) {
        out->error = grow(out, n);
    }
    if (out->error) {
        return NULL;
    }
    uint8_t *room = out->bytes + out->size;
    out->size += n;
    return room;
}

void iso_fleet_put(struct iso_fleet_bytes *out, const void *bytes, size_t n)
{
    uint8_t *room = n > 0 ? iso_fleet_bytes_room(out, n) : NULL;
    if (room) {
        memcpy(room, bytes, n);
    }
}

void iso_fleet_put_u8(struct iso_fleet_bytes *out, uint8_t value)
{
    iso_fleet_put(out, &value, 1);
}

void iso_fleet_put_u32(struct iso_fleet_bytes *out, uint32_t value)
{
    uint8_t bytes[4];
    (void)iso_put_u32(bytes, value);
    iso_fleet_put(out, bytes, sizeof bytes);
}

void iso_fleet_put_u64(struct iso_fleet_bytes *out, uint64_t value)
{
    uint8_t bytes[8];
    (void)iso_put_u64(bytes, value);
    iso_fleet_put(out, bytes, sizeof bytes);
}

void iso_fleet_put_text(struct iso_fleet_bytes *out, const char *text)
{
    const size_t length = strlen(text);
    iso_fleet_put_u32(out, (uint32_t)length);
    iso_fleet_put(out, text, length);
}

const uint8_t *iso_fleet_take(struct iso_fleet_reader *in, size_t n)
{
    if (in->bad || n > in->left) {
        in->bad = true;
        return NULL;
    }
    const uint8_t *bytes = in->bytes;
    in->bytes += n;
    in->left -= n;
    return bytes;
}

void iso_fleet_take_bytes(struct iso_fleet_reader *in, void *out, size_t n)
{
    const uint8_t *bytes = iso_fleet_take(in, n);
    if (bytes) {
        memcpy(out, bytes, n);
    } else {
        memset(out, 0, n);
    }
}

uint8_t iso_fleet_take_u8(struct iso_fleet_reader *in)
{
    const uint8_t *bytes = iso_fleet_take(in, 1);
    return bytes ? *bytes : 0;
}

uint32_t iso_fleet_take_u32(struct iso_fleet_reader *in)
{
    const uint8_t *bytes = iso_fleet_take(in, 4);
    return bytes ? iso_get_u32(bytes) : 0;
}

uint64_t iso_fleet_take_u64(struct iso_fleet_reader *in)
{
    const uint8_t *bytes = iso_fleet_take(in, 8);
    return bytes ? iso_get_u64(bytes) : 0;
}

const char *iso_fleet_take_text(struct iso_fleet_reader *in, size_t most, size_t *length)
{
    const uint32_t n = iso_fleet_take_u32(in);
    if (n > most) {
        in->bad = true;
    }
    const uint8_t *bytes = iso_fleet_take(in, n);
    if (bytes && memchr(bytes, 0, n)) {
        in->bad = true;
    }
    *length = in->bad ? 0 : n;
    return in->bad ? "" : (const char *)bytes;
}

bool iso_fleet_reader_is_done(const struct iso_fleet_reader *in)
{
    return !in->bad && in->left == 0;
}
