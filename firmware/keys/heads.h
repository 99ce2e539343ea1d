/* What the stores of one appliance (gallery, audit log, lock-out file, key ring) know of each
 * other, so that files of different times are recognised.
 *
 * Each store counts its own changes. Each time it writes, it seals the counts of all stores at that
 * moment into the same write. This is its knowledge. So each file states the least count that the
 * others must have. When the files are opened, each count is compared with the knowledge of the
 * other files: a store with a lower count was taken from an earlier time. The knowledge of the log
 * also has the link after its last record, so that a log with another history and the same number
 * of records is recognised.
 *
 * A count enters the knowledge only when its change is on the disk: for gallery and log that is the
 * value of their anchor (anchor.h). So a kill, a power failure or a failed write at any moment
 * leaves files that agree; a difference that an interruption can cause is never refused. Files that
 * agree were on the disk together at one moment. So only a whole directory of an earlier time is
 * not recognised here; state_counter.h recognises it (C. J. Fidge, "Timestamps in message-passing
 * systems that preserve the partial ordering", 1988: vector clocks and consistent cuts).
 *
 * The board holds these counts in memory. The key ring owns the board, since all stores have the
 * ring. Its functions may be called by several threads. */
#ifndef ISO_FIRMWARE_KEYS_HEADS_H
#define ISO_FIRMWARE_KEYS_HEADS_H

#include <stdint.h>

#include "core/base/fault.h"

/* The order is that of the bytes in the files. */
enum iso_head {
    ISO_HEAD_GALLERY, /* changes, as anchored */
    ISO_HEAD_LOG,     /* records, as anchored */
    ISO_HEAD_LOCKOUT, /* number of the lock-out file */
    ISO_HEAD_RING,    /* number of the key ring's file */
    ISO_HEADS
};

enum {
    ISO_HEADS_LINK_BYTES = 32,
    ISO_HEADS_COUNT_BYTES = 8 * ISO_HEADS,
    ISO_HEADS_BYTES = ISO_HEADS_COUNT_BYTES + ISO_HEADS_LINK_BYTES,
};

/* All zero: nothing is known, as in files of formats that had no knowledge. */
struct iso_heads {
    uint64_t count[ISO_HEADS];
    uint8_t link[ISO_HEADS_LINK_BYTES]; /* the link after record count[ISO_HEAD_LOG] */
};

/* Writes the knowledge as bytes, and reads it. Any ISO_HEADS_BYTES bytes can be read: the seal
 * around them proves that they are genuine. */
void iso_heads_put(const struct iso_heads *heads, uint8_t bytes[ISO_HEADS_BYTES]);
struct iso_heads iso_heads_get(const uint8_t bytes[ISO_HEADS_BYTES]);

/* The counts alone, for the records of the log, which are chained to each other and need no link.
 * There the log's own count is 1 + the value that its anchor had on the disk when the record was
 * written; 0: not known. */
void iso_heads_put_counts(const struct iso_heads *heads, uint8_t bytes[ISO_HEADS_COUNT_BYTES]);
struct iso_heads iso_heads_get_counts(const uint8_t bytes[ISO_HEADS_COUNT_BYTES]);

struct iso_heads_board;

/* Makes an empty board. -ENOMEM. */
int iso_heads_board_new(struct iso_heads_board **out) __attribute__((warn_unused_result));

/* Frees it. NULL is accepted. */
void iso_heads_board_free(struct iso_heads_board *board);

/* ---- when a store is opened ---- */

/* Reports that a store has this count on the disk. `path`: the file that a fault names as the old
 * one. */
void iso_heads_found(struct iso_heads_board *board, enum iso_head head, const char *path,
                     uint64_t count);

/* Reports the knowledge of the file at `witness`, in place of its earlier report. */
void iso_heads_claim(struct iso_heads_board *board, const char *witness,
                     const struct iso_heads *known);

/* Reports that the log has this link after this record. Links of earlier claims are compared with
 * it. */
void iso_heads_record(struct iso_heads_board *board, uint64_t sequence,
                      const uint8_t link[ISO_HEADS_LINK_BYTES]);

/* Compares the counts that were found with those that were claimed, once all stores are open.
 * -ESTALE: the fault names the old file and the file that knows it. iso_lockout_load, and not this
 * function, judges a missing lock-out file. */
int iso_heads_check(struct iso_heads_board *board, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Forgets the knowledge of the files, because an administrator accepts the stores as they are. Each
 * store has to be written afterwards. */
void iso_heads_accept(struct iso_heads_board *board);

/* ---- when a store writes ---- */

/* The knowledge for a file that is written now. */
struct iso_heads iso_heads_now(struct iso_heads_board *board);

/* Reports that the store's count is on the disk. link: of the log, else NULL. */
void iso_heads_wrote(struct iso_heads_board *board, enum iso_head head, uint64_t count,
                     const uint8_t *link);

#endif
