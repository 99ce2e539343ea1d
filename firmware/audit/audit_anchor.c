/* The anchor of the log: its contents, and the comparison with it when the log is opened. */
#include <errno.h>
#include <inttypes.h>
#include <sodium.h>
#include <string.h>
#include <unistd.h>

#include "core/base/bytes.h"
#include "drivers/file/disk_wait.h"
#include "drivers/file/storage_fault.h"
#include "firmware/audit/audit_state.h"

/* ---- the anchor: first sequence u64, head[32], sealing u8, lax u8, first sequence of the segment
 * that is written u64 (0: unknown), closed segments from the first sequence on u16, number of the
 * counter of the state u32 (0: none, state_counter.h) ---- */

/* lax: records are not synchronised, so the log may be ahead of the anchor. */
enum {
    EXTRA_HEAD = 8,
    EXTRA_SEALING = EXTRA_HEAD + ISO_AUDIT_LINK_BYTES,
    EXTRA_LAX,
    EXTRA_SEGMENT,
    EXTRA_CLOSED = EXTRA_SEGMENT + 8,
    EXTRA_COUNTER = EXTRA_CLOSED + 2,
    EXTRA_END = EXTRA_COUNTER + 4,
};

_Static_assert((int)EXTRA_END <= (int)ISO_ANCHOR_EXTRA_BYTES, "the anchor has room for it");

/* Counts the closed segments whose first sequence is at least `from` and below `to`. */
static uint16_t count_closed(const struct iso_audit *audit, uint64_t from, uint64_t to)
{
    uint16_t n = 0;
    for (size_t i = 0; i < audit->closed.n; i++) {
        if (audit->closed.first[i] >= from && audit->closed.first[i] < to) {
            n++;
        }
    }
    return n;
}

static uint32_t found_number(const struct iso_audit *audit)
{
    return audit->anchor ? iso_get_u32(iso_anchor_state(audit->anchor)->extra + EXTRA_COUNTER) : 0;
}

struct iso_anchor_state iso__audit_anchor_state(const struct iso_audit *audit, bool sealing)
{
    struct iso_anchor_state state = {.value = audit->last};
    (void)iso_put_u64(state.extra, audit->first);
    memcpy(state.extra + EXTRA_HEAD, audit->link.bytes, ISO_AUDIT_LINK_BYTES);
    state.extra[EXTRA_SEALING] = sealing;
    state.extra[EXTRA_LAX] = !audit->options.sync;
    (void)iso_put_u64(state.extra + EXTRA_SEGMENT, audit->segment_first);
    (void)iso_put_u16(state.extra + EXTRA_CLOSED,
                      count_closed(audit, audit->first, audit->segment_first));
    (void)iso_put_u32(state.extra + EXTRA_COUNTER,
                      audit->options.counter ? iso_state_counter_next(audit->options.counter)
                                             : found_number(audit));
    return state;
}

bool iso__audit_anchor_is_sealing(const struct iso_audit *audit)
{
    return audit->anchor && iso_anchor_state(audit->anchor)->extra[EXTRA_SEALING];
}

bool iso__audit_wants_number(const struct iso_audit *audit)
{
    return audit->options.counter && iso_state_counter_is_due(audit->options.counter);
}

int iso__audit_write_anchor(struct iso_audit *audit, struct iso_fault *fault)
{
    const struct iso_anchor_state state = iso__audit_anchor_state(audit, false);
    if (!audit->options.sync && audit->fd >= 0 && iso_disk_wait_fdatasync(audit->fd)) {
        return iso_storage_refused(audit->path, -errno, fault);
    }
    const int error = iso_anchor_set(audit->anchor, &state, fault);
    if (!error) {
        iso_heads_wrote(iso_key_ring_board(audit->options.ring), ISO_HEAD_LOG, state.value,
                        state.extra + EXTRA_HEAD);
        if (audit->options.counter) {
            iso_state_counter_wrote(audit->options.counter,
                                    iso_get_u32(state.extra + EXTRA_COUNTER));
        }
    }
    return error;
}

/* Called before the segments are read. Tells the board the count of the log (the value of the
 * anchor) and what the anchor knows of the other stores. */
void iso__audit_tell_anchor(const struct iso_audit *audit)
{
    struct iso_heads_board *board = iso_key_ring_board(audit->options.ring);
    if (!audit->anchor) {
        iso_heads_found(board, ISO_HEAD_LOG, audit->path, 0);
        return;
    }
    const struct iso_anchor_state *state = iso_anchor_state(audit->anchor);
    if (audit->options.counter) {
        iso_state_counter_found(audit->options.counter, found_number(audit));
    }
    iso_heads_found(board, ISO_HEAD_LOG, audit->path, state->value);
    iso_heads_claim(board, audit->anchor_path, iso_anchor_known(audit->anchor));
    iso_heads_wrote(board, ISO_HEAD_LOG, state->value, state->extra + EXTRA_HEAD);
}

bool iso__audit_is_anchored(const struct iso_audit *audit, const struct iso_audit_link *link)
{
    return sodium_memcmp(iso_anchor_state(audit->anchor)->extra + EXTRA_HEAD, link->bytes,
                         ISO_AUDIT_LINK_BYTES) == 0;
}

uint64_t iso__audit_anchored_first(const struct iso_audit *audit)
{
    return iso_get_u64(iso_anchor_state(audit->anchor)->extra);
}

bool iso__audit_anchor_is_lax(const struct iso_audit *audit)
{
    return iso_anchor_state(audit->anchor)->extra[EXTRA_LAX];
}

static bool is_closed(const struct iso_audit *audit, uint64_t first)
{
    return count_closed(audit, first, first + 1) == 1;
}

int iso__audit_check_closed(const struct iso_audit *audit, bool closed, struct iso_fault *fault)
{
    const uint8_t *extra = iso_anchor_state(audit->anchor)->extra;
    const uint64_t segment = iso_get_u64(extra + EXTRA_SEGMENT);
    const uint16_t n = iso_get_u16(extra + EXTRA_CLOSED);
    if (count_closed(audit, audit->segment_first + closed, UINT64_MAX) > 0) {
        return iso_fault_set_code(fault, ISO_FAULT_LOG_OLD, -ESTALE,
                                  "%s: an old segment: there are closed ones of later records",
                                  audit->path);
    }
    if (segment == 0) {
        /* An anchor of an older version does not name the segment. */
        return 0;
    }
    if (audit->segment_first < segment) {
        return iso_fault_set_code(fault, ISO_FAULT_LOG_OLD, -ESTALE,
                                  "%s: an old segment: the newest begins with record %" PRIu64,
                                  audit->path, segment);
    }
    if (audit->segment_first > segment && segment >= audit->first && !is_closed(audit, segment)) {
        return iso_fault_set_code(fault, ISO_FAULT_LOG_OLD, -ESTALE,
                                  "%s: the segment of record %" PRIu64 " is missing", audit->path,
                                  segment);
    }
    const uint16_t found = count_closed(audit, audit->first, segment);
    return found == n ? 0
                      : iso_fault_set_code(fault, ISO_FAULT_LOG_OLD, -ESTALE,
                                           "%s: %u closed segments instead of %u; put back "
                                           "what is missing",
                                           audit->path, found, n);
}
