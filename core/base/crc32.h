/* CRC-32 (IEEE 802.3, reflected, polynomial 0xEDB88320) of the files that core parses, by zlib. */
#ifndef ISO_CORE_BASE_CRC32_H
#define ISO_CORE_BASE_CRC32_H

#include <stddef.h>
#include <stdint.h>

/* Start with crc = 0; feed further bytes with the value returned. */
uint32_t iso_crc32(uint32_t crc, const void *bytes, size_t size);

#endif
