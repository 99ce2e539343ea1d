/* Stores the state of the lock-out in a file, so that it survives a power cut.
 *
 *   ISOLOCK2 | number of the key u32 | sealed: number of the file u64, failures u32, attacks u32,
 *   locks u32, remaining_ms u64, lockdown u8, heads (heads.h)
 *
 * The file is sealed with the anchors' key, so only a program that has the key ring can write a
 * valid one. Each write increases the number of the file, and the other stores record this number.
 * Therefore an older file is refused, and a missing file is refused if a file was written before.
 * A write creates a new file in the same directory and then renames it to the final name. After a
 * power cut, the final name refers to either the old file or the new file, and that file is whole.
 *
 * Format 1 was a line of text with a CRC-32, which anyone could write. It is read as long as no
 * store knows of a sealed file; the next write replaces it. */
#ifndef ISO_FIRMWARE_VISIT_LOCKOUT_FILE_H
#define ISO_FIRMWARE_VISIT_LOCKOUT_FILE_H

#include <stddef.h>

#include "core/base/fault.h"
#include "firmware/keys/key_ring.h"
#include "firmware/visit/lockout.h"

enum { ISO_LOCKOUT_PLAIN_BYTES = 8 + 3 * 4 + 8 + 1 + ISO_HEADS_BYTES };

struct iso_lockout_file {
    uint64_t number; /* 0: format 1, which had no number */
    struct iso_lockout_record record;
    struct iso_heads known;
};

/* Reads the file, and tells the ring's board what was found. After an error *out is unchanged:
 *   -ENOENT  there is none, and no store knows of one (the fault is unchanged then)
 *   -ESTALE  there is none, or an older one, and a store knows of a newer one
 *   -EBADMSG it is damaged, or sealed with a key that is not in the ring
 * Otherwise it is an errno of reading the file. */
int iso_lockout_load(const char *path, const struct iso_key_ring *ring,
                     struct iso_lockout_file *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads the file, whatever the other stores know. After an error *out is unchanged: -ENOENT there
 * is none (the fault is unchanged then), -EBADMSG it is damaged or sealed with another key, or an
 * errno of reading the file. */
int iso_lockout_read(const char *path, const struct iso_key_ring *ring,
                     struct iso_lockout_file *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes the file with the next number; it is on the disk when this returns 0. An error of
 * storage_fault.h: then the file has the old contents, or the new ones without being synchronised;
 * iso_lockout_read finds out which. */
int iso_lockout_save(const char *path, const struct iso_key_ring *ring,
                     const struct iso_lockout_record *record, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes the bytes that are sealed, and reads them. get: -EBADMSG for a size or numbers that are
 * not possible. */
void iso_lockout_put(const struct iso_lockout_file *file, uint8_t plain[ISO_LOCKOUT_PLAIN_BYTES]);
int iso_lockout_get(const uint8_t *plain, size_t size, struct iso_lockout_file *out)
    __attribute__((warn_unused_result));

/* Reads the text of a file of format 1, of `size` bytes and a NUL. -EBADMSG. */
int iso_lockout_parse(const char *text, size_t size, struct iso_lockout_record *out)
    __attribute__((warn_unused_result));

#endif
