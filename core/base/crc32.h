/* CRC-32 (IEEE 802.3, reflected, polynomial 0xEDB88320) of the files that core parses, by zlib. */
#ifndef ISO_CORE_BASE_CRC32_H
#define ISO_CORE_BASE_CRC32_H

#include <stddef.h>
#include <stdint.h>

/* Returns the checksum of `size` bytes. The first call gets crc = 0. To continue with further
 * bytes, pass the value that the previous call returned. */
uint32_t iso_crc32(uint32_t crc, const void *bytes, size_t size);

#endif
