/* Writing and reading the fields of a message. A writer and a reader remember their first error, so
 * that a sequence of fields is checked once, at its end. Numbers are little-endian. Internal to
 * firmware/fleet/message. */
#ifndef ISO_FIRMWARE_FLEET_MESSAGE_WIRE_H
#define ISO_FIRMWARE_FLEET_MESSAGE_WIRE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Bytes that grow. All zero is empty. */
struct iso_fleet_bytes {
    uint8_t *bytes;
    size_t size, capacity;
    int error; /* 0, or -ENOMEM: a field is missing */
};

/* Wipes and frees the bytes. */
void iso_fleet_bytes_free(struct iso_fleet_bytes *out);

/* Adds room for n bytes, which are not set, and returns it; NULL only when there is no memory, also
 * for 0 bytes. Growing wipes the old memory. */
uint8_t *iso_fleet_bytes_room(struct iso_fleet_bytes *out, size_t n);

void iso_fleet_put(struct iso_fleet_bytes *out, const void *bytes, size_t n);
void iso_fleet_put_u8(struct iso_fleet_bytes *out, uint8_t value);
void iso_fleet_put_u32(struct iso_fleet_bytes *out, uint32_t value);
void iso_fleet_put_u64(struct iso_fleet_bytes *out, uint64_t value);

/* A text with its length as u32, without a NUL. */
void iso_fleet_put_text(struct iso_fleet_bytes *out, const char *text);

/* Bytes that are read from the beginning to the end. */
struct iso_fleet_reader {
    const uint8_t *bytes;
    size_t left;
    bool bad; /* a field did not fit */
};

/* The next n bytes, or NULL. */
const uint8_t *iso_fleet_take(struct iso_fleet_reader *in, size_t n);

/* Copies n bytes; zeros if there are not so many. */
void iso_fleet_take_bytes(struct iso_fleet_reader *in, void *out, size_t n);
uint8_t iso_fleet_take_u8(struct iso_fleet_reader *in);
uint32_t iso_fleet_take_u32(struct iso_fleet_reader *in);
uint64_t iso_fleet_take_u64(struct iso_fleet_reader *in);

/* A text of at most `most` bytes, which lies in the message and has no NUL at its end; it is bad if
 * it contains a NUL. */
const char *iso_fleet_take_text(struct iso_fleet_reader *in, size_t most, size_t *length);

/* Whether all fields fitted and nothing is left. */
bool iso_fleet_reader_is_done(const struct iso_fleet_reader *in);

#endif
