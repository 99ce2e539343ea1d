/* An anchor is a sealed number beside a store. It only rises, so that an old copy of the store
 * that is put back is recognised.
 *
 * A store counts its changes. It writes a change, and then the anchor. So the number of the store
 * is that of the anchor, or one more after a kill between the two. The log writes groups of
 * records: there it is as many more as the group has records. A store that is behind its anchor is
 * an old one. If the anchor cannot be written the store is ahead of it, and has to catch up
 * (iso_anchor_set again) before the next change.
 *
 * What an anchor can tell: that its store was exchanged for an older one, or cut short. An anchor
 * that was exchanged with its store is found by what the other stores know (heads.h), and what it
 * knows of them stands in it. The files of a directory cannot show that the whole directory is of
 * an earlier time; a counter in a TPM can (state_counter.h). Where there is none, the head of the
 * log goes to the journal of the system with every record: a journal that is kept elsewhere, or a
 * note of what `isotherm log verify` said, shows it.
 *
 * The file has two slots that are written in turn. A slot that was cut short does not count; the
 * other one is one behind then. Slot: number of the key u32, then sealed: turn u64, value u64,
 * extra[], heads. Format 1, which is still read, has no heads. */
#ifndef ISO_FIRMWARE_AUDIT_ANCHOR_H
#define ISO_FIRMWARE_AUDIT_ANCHOR_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "firmware/keys/key_ring.h"

enum { ISO_ANCHOR_EXTRA_BYTES = 56 };

struct iso_anchor_state {
    uint64_t value;
    uint8_t extra[ISO_ANCHOR_EXTRA_BYTES]; /* what the store likes to remember with it */
};

struct iso_anchor;

/* Opens the anchor at `path`; kind (a constant of the source) tells those of different stores
 * apart. ring must outlive it. -ENOENT there is none (the fault says nothing), -EBADMSG damaged or
 * of another store, -EIO, -ENOMEM, ... */
int iso_anchor_open(const char *path, const char *kind, const struct iso_key_ring *ring, bool sync,
                    struct iso_anchor **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Makes one in this state, in the place of one that there may be, and opens it. */
int iso_anchor_make(const char *path, const char *kind, const struct iso_key_ring *ring, bool sync,
                    const struct iso_anchor_state *state, struct iso_anchor **out,
                    struct iso_fault *fault) __attribute__((warn_unused_result));
void iso_anchor_close(struct iso_anchor *anchor);

const struct iso_anchor_state *iso_anchor_state(const struct iso_anchor *anchor);

/* What the anchor knows of the other stores; each write takes it from the ring's board. */
const struct iso_heads *iso_anchor_known(const struct iso_anchor *anchor);

/* Writes another state, sealed with the newest key; with `sync` it is on the disk afterwards. -EIO
 * with the old one, or the new one, in force. */
int iso_anchor_set(struct iso_anchor *anchor, const struct iso_anchor_state *state,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
