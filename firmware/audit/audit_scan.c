/* Opening the log: its newest segment is read to the end and compared with the anchor.
 *
 * A crash while a group of records is written leaves the log ahead of its anchor by at most the
 * number of records in the group. If an old anchor is put back, the log is ahead of it, too. The
 * records tell these two cases apart: each has sealed into it the value that the anchor had on the
 * disk when the record was written. The anchor must have at least that value. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"
#include "drivers/file/storage_fault.h"
#include "firmware/audit/audit_state.h"
#include "firmware/contract/json_member.h"

static int refuse(const struct iso_audit *audit, int error, uint64_t sequence, const char *flaw,
                  struct iso_fault *fault)
{
    return iso_fault_set_code(
        fault, error == -ESTALE ? ISO_FAULT_LOG_OLD : ISO_FAULT_LOG_DAMAGED, error,
        "%s: record %" PRIu64 " %s; move the log and its anchor away (see --accept-state)",
        audit->path, sequence, flaw);
}

int iso__audit_stale(const struct iso_audit *audit, enum iso_fault_code code, const char *what,
                     struct iso_fault *fault)
{
    return iso_fault_set_code(fault, code, -ESTALE,
                              "%s: %s; move the log and its anchor away (see --accept-state)",
                              audit->path, what);
}

/* Stores what a record says about the gallery: "gallery":"ID:CHANGES". */
static void note_gallery(struct iso_audit *audit, const char *text)
{
    char value[48], gallery[20];
    uint64_t changes;
    if (iso_json_member(text, "gallery", value, sizeof value) &&
        sscanf(value, "%16[0-9a-f]:%" SCNu64, gallery, &changes) == 2) {
        memcpy(audit->gallery, gallery, sizeof gallery);
        audit->gallery_changes = changes;
    }
}

/* Stores what a record proves about the anchor: its value when the record was written. When a
 * record without this value was written, the anchor was at most one record behind it. */
static void note_proof(struct iso_audit *audit)
{
    const uint64_t said = audit->known.count[ISO_HEAD_LOG];
    const uint64_t proved = said > 0 ? said - 1 : audit->last - 1;
    audit->proved = proved > audit->proved ? proved : audit->proved;
    audit->known.count[ISO_HEAD_LOG] = 0; /* this count is not a claim about another store */
}

/* Updates the log with the record that the reader has just read. */
static int take_record(struct iso_audit *audit, const struct iso_audit_reader *reader,
                       struct iso_fault *fault)
{
    const uint64_t anchored = iso_anchor_state(audit->anchor)->value;
    if (iso__audit_reserve_mark(audit)) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", audit->path);
    }
    iso__audit_count_line(audit, (size_t)(reader->position - audit->size));
    audit->link = reader->link;
    audit->known = reader->record.known;
    note_proof(audit);
    iso_heads_record(iso_key_ring_board(audit->options.ring), audit->last, audit->link.bytes);
    if (audit->last == anchored && !iso__audit_is_anchored(audit, &audit->link)) {
        return refuse(audit, -ESTALE, audit->last, "is of another log than the anchor", fault);
    }
    note_gallery(audit, reader->record.text);
    iso__audit_note_clock(audit, reader->record.text);
    return 0;
}

/* Sets the beginning of the segment from its header. */
static int take_header(struct iso_audit *audit, const struct iso_audit_reader *reader,
                       struct iso_fault *fault)
{
    const struct iso_audit_header *header = &reader->header;
    const uint64_t anchored = iso_anchor_state(audit->anchor)->value;
    audit->seal = reader->seal;
    audit->segment_first = header->first;
    audit->last = header->first - 1;
    audit->link = header->link;
    audit->size = reader->position;
    audit->n_marks = 0;
    audit->proved = audit->last > 0 ? audit->last - 1 : 0;
    iso_heads_record(iso_key_ring_board(audit->options.ring), audit->last, audit->link.bytes);
    return audit->last == anchored && !iso__audit_is_anchored(audit, &audit->link)
               ? refuse(audit, -ESTALE, header->first, "is of another log than the anchor", fault)
               : 0;
}

/* Reads a segment to its end. Finds the head, and how many bytes follow the last complete line. */
int iso__audit_scan(struct iso_audit *audit, const char *path, size_t *torn,
                    struct iso_fault *fault)
{
    struct iso_audit_reader *reader = malloc(sizeof *reader);
    if (!reader) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", audit->path);
    }
    int error = iso_audit_reader_open(reader, path, audit->options.ring);
    if (error == -EBADMSG) {
        error = iso_fault_set_code(fault, ISO_FAULT_LOG_DAMAGED, error,
                                   "%s: %s; move the log and its anchor away (see "
                                   "--accept-state)",
                                   path, reader->flaw);
    } else if (error) {
        error = iso_file_fault(path, error, fault);
        error = iso_storage_reword(path, error, fault);
    } else {
        error = take_header(audit, reader, fault);
    }
    int more = 0;
    while (!error && (more = iso_audit_reader_next(reader)) > 0) {
        error = take_record(audit, reader, fault);
    }
    if (!error && more < 0) {
        error = more == -EBADMSG ? refuse(audit, more, reader->next, reader->flaw, fault)
                                 : iso_fault_set_code(fault, ISO_FAULT_DISK_FAILED, more,
                                                      "%s: cannot be read", path);
    }
    *torn = reader->torn;
    iso_audit_reader_close(reader);
    free(reader);
    return error;
}

int iso__audit_check_end(struct iso_audit *audit, bool closed, struct iso_fault *fault)
{
    const struct iso_anchor_state *anchor = iso_anchor_state(audit->anchor);
    audit->first = iso__audit_anchored_first(audit);
    if (audit->last < anchor->value) {
        return refuse(audit, -ESTALE, audit->last + 1, "and what came after it are missing", fault);
    }
    const bool lax = iso__audit_anchor_is_lax(audit);
    if (!lax && audit->proved > anchor->value) {
        return iso__audit_stale(audit, ISO_FAULT_LOG_OLD, "its anchor is an old one", fault);
    }
    const int error = iso__audit_check_closed(audit, closed, fault);
    if (error) {
        return error;
    }
    iso_heads_claim(iso_key_ring_board(audit->options.ring), audit->path, &audit->known);
    return (lax && audit->last > anchor->value) || iso__audit_anchor_is_sealing(audit) ||
                   lax == audit->options.sync
               ? iso__audit_write_anchor(audit, fault)
               : 0;
}
