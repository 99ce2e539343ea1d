/* Little-endian numbers in byte buffers. Put functions return the byte after what they wrote. */
#ifndef ISO_CORE_BASE_BYTES_H
#define ISO_CORE_BASE_BYTES_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Copies n bytes. */
static inline uint8_t *iso_put_bytes(uint8_t *p, const void *bytes, size_t n)
{
    memcpy(p, bytes, n);
    return p + n;
}

/* Writes 2 bytes, the low one first. */
static inline uint8_t *iso_put_u16(uint8_t *p, uint16_t v)
{
    p[0] = (uint8_t)(v & 0xff);
    p[1] = (uint8_t)(v >> 8);
    return p + 2;
}

/* Writes 4 bytes, the low one first. */
static inline uint8_t *iso_put_u32(uint8_t *p, uint32_t v)
{
    p = iso_put_u16(p, (uint16_t)(v & 0xffff));
    return iso_put_u16(p, (uint16_t)(v >> 16));
}

/* Writes 8 bytes, the low one first. */
static inline uint8_t *iso_put_u64(uint8_t *p, uint64_t v)
{
    p = iso_put_u32(p, (uint32_t)(v & 0xffffffff));
    return iso_put_u32(p, (uint32_t)(v >> 32));
}

/* Writes the bits of an IEEE 754 single as 4 bytes, the low one first. */
static inline uint8_t *iso_put_f32(uint8_t *p, float v)
{
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    return iso_put_u32(p, bits);
}

/* Reads 2 bytes, the low one first. */
static inline uint16_t iso_get_u16(const uint8_t *p)
{
    return (uint16_t)(p[0] | p[1] << 8);
}

/* Reads 4 bytes, the low one first. */
static inline uint32_t iso_get_u32(const uint8_t *p)
{
    return (uint32_t)iso_get_u16(p) | (uint32_t)iso_get_u16(p + 2) << 16;
}

/* Reads 8 bytes, the low one first. */
static inline uint64_t iso_get_u64(const uint8_t *p)
{
    return (uint64_t)iso_get_u32(p) | (uint64_t)iso_get_u32(p + 4) << 32;
}

/* Reads an IEEE 754 single of 4 bytes, the low one first. */
static inline float iso_get_f32(const uint8_t *p)
{
    uint32_t bits = iso_get_u32(p);
    float v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

#endif
