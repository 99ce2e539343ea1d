/* A small file that is sealed with a key of the ring and replaced as a whole.
 *
 *   magic[8] | number of the key u32 | sealed bytes (seal.h); the label is the kind and the number
 *
 * Only a program that has the key ring can write a valid file. A write creates a new file in the
 * same directory and renames it, so after a power cut the file is the old one or the new one. */
#ifndef ISO_FIRMWARE_KEYS_SEALED_FILE_H
#define ISO_FIRMWARE_KEYS_SEALED_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "firmware/keys/key_ring.h"

enum { ISO_SEALED_FILE_HEAD_BYTES = 8 + 4, ISO_SEALED_FILE_PLAIN_MAX = 16 << 10 };

/* What one kind of file is. */
struct iso_sealed_file {
    const char *magic;           /* 8 characters */
    const char *kind;            /* of the label; a constant of the source, below 64 characters */
    enum iso_key_use use;        /* of the key */
    size_t plain_min, plain_max; /* how many bytes may be sealed; at most
                                  * ISO_SEALED_FILE_PLAIN_MAX */
};

/* Whether the bytes begin with the magic of this kind. */
bool iso_sealed_file_is(const struct iso_sealed_file *kind, const void *bytes, size_t size);

/* Opens the bytes of a file into `plain`, which has room for kind->plain_max bytes and which the
 * caller wipes. -EBADMSG: another kind, damaged, or sealed with a key that is not in the ring. */
int iso_sealed_file_open(const struct iso_sealed_file *kind, const struct iso_key_ring *ring,
                         const void *bytes, size_t size, void *plain, size_t *plain_size)
    __attribute__((warn_unused_result));

/* Reads and opens a file. -ENOENT there is none (the fault is unchanged then), -EBADMSG as above
 * (the caller sets the fault), or an errno of reading it, with a fault. */
int iso_sealed_file_read(const char *path, const struct iso_sealed_file *kind,
                         const struct iso_key_ring *ring, void *plain, size_t *plain_size,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

/* Replaces the file; it is on the disk when this returns 0. `key` has the number `number` in the
 * ring. An error of storage_fault.h: then the file has the old contents, or the new ones without
 * being synchronised. -ENOMEM. */
int iso_sealed_file_write(const char *path, const struct iso_sealed_file *kind,
                          const struct iso_seal_key *key, uint32_t number, const void *plain,
                          size_t size, struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
