/* An anchor is a sealed number in a file beside a store. It only rises, so that an old copy of the
 * store is recognised if it is put back.
 *
 * A store counts its changes. It writes a change first, and then the anchor. So the count of the
 * store equals the anchor, or is one more if the program was killed between the two. The log writes
 * records in groups, so its count may be ahead by as many records as one group has. A store that is
 * behind its anchor is an old one. If the anchor cannot be written, the store is ahead of it, and
 * has to catch up (iso_anchor_set again) before the next change.
 *
 * An anchor shows that its store was replaced by an older one, or cut short. If an anchor was
 * replaced together with its store, the knowledge of the other stores shows that (heads.h); the
 * anchor contains what it knows of them. The files of a directory cannot show that the whole
 * directory is of an earlier time, but a counter in a TPM can (state_counter.h). Without a TPM, the
 * head of the log goes to the journal of the system with every record. Then a journal that is kept
 * elsewhere, or a note of the output of `isotherm log verify`, shows it.
 *
 * The file has two slots that are written in turn. A slot that was cut short does not count; then
 * the other slot, which is one behind, is used. Slot: number of the key u32, then sealed: turn u64,
 * value u64, extra[], heads. Format 1, which can still be read, has no heads. */
#ifndef ISO_FIRMWARE_AUDIT_ANCHOR_H
#define ISO_FIRMWARE_AUDIT_ANCHOR_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "firmware/keys/key_ring.h"

enum { ISO_ANCHOR_EXTRA_BYTES = 56 };

struct iso_anchor_state {
    uint64_t value;
    uint8_t extra[ISO_ANCHOR_EXTRA_BYTES]; /* more data of the store */
};

struct iso_anchor;

/* Opens the anchor at `path`. kind (a constant of the source) distinguishes the anchors of
 * different stores. sync: every write is synchronised. ring must outlive it. -ENOENT there is none
 * (the fault is not set), -EBADMSG damaged or of another store, -EIO, -ENOMEM, ... */
int iso_anchor_open(const char *path, const char *kind, const struct iso_key_ring *ring, bool sync,
                    struct iso_anchor **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Makes an anchor in this state, which replaces an existing one, and opens it. Errors of
 * iso_data_file_replace and iso_anchor_open, but -EIO instead of -ENOENT. */
int iso_anchor_make(const char *path, const char *kind, const struct iso_key_ring *ring, bool sync,
                    const struct iso_anchor_state *state, struct iso_anchor **out,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

/* Closes and frees it. NULL is accepted. */
void iso_anchor_close(struct iso_anchor *anchor);

/* The state that was read or written last. Valid as long as the anchor is open. */
const struct iso_anchor_state *iso_anchor_state(const struct iso_anchor *anchor);

/* The knowledge of the anchor about the other stores. Each write takes it from the ring's board. */
const struct iso_heads *iso_anchor_known(const struct iso_anchor *anchor);

/* Writes another state, sealed with the newest key. With `sync` it is on the disk afterwards. After
 * -EIO either the old state or the new one is valid. */
int iso_anchor_set(struct iso_anchor *anchor, const struct iso_anchor_state *state,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
