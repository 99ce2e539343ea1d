/* Segments of the log: closing one, beginning the next, deleting the oldest.
 *
 * The new segment is complete under another name (PATH.new) before the old one is renamed. If the
 * daemon is killed, the worst case is that there is no file at PATH; the next start then begins one
 * after the newest closed segment. */
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "drivers/file/directory.h"
#include "drivers/file/file.h"
#include "drivers/file/storage_fault.h"
#include "firmware/audit/audit_state.h"
#include "firmware/contract/validity.h"

/* Deletes the keys that no segment needs any more: those older than the key of the oldest
 * segment. */
static int drop_keys(struct iso_audit *audit, struct iso_fault *fault)
{
    uint32_t number = audit->seal.key_number;
    if (audit->closed.n > 0) {
        char path[PATH_MAX], line[ISO_AUDIT_LINE_MAX] = "";
        struct iso_audit_header header;
        const int error = iso_audit_segment_path(audit->path, audit->closed.first[0], path, fault);
        if (error) {
            return error;
        }
        FILE *file = NULL;
        const bool read = iso_file_stream(path, ISO_FILE_ANY_SIZE, &file, NULL) == 0 &&
                          fgets(line, sizeof line, file);
        line[strcspn(line, "\n")] = '\0';
        if (file) {
            (void)fclose(file);
        }
        if (!read || iso_audit_header_get(line, &header)) {
            /* The segment cannot be read, so no key is deleted. The check of the whole log
             * reports it. */
            return 0;
        }
        number = header.key_number;
    }
    return iso_key_ring_drop(audit->options.ring, ISO_KEY_LOG, number, fault);
}

static void forget_old(struct iso_audit_segments *segments)
{
    segments->n--;
    memmove(segments->first, segments->first + 1, segments->n * sizeof *segments->first);
}

static int remove_segment(const struct iso_audit *audit, uint64_t first, struct iso_fault *fault)
{
    char path[PATH_MAX];
    const int error = iso_audit_segment_path(audit->path, first, path, fault);
    if (!error && unlink(path) && errno != ENOENT) {
        return iso_storage_refused(path, -errno, fault);
    }
    return error;
}

/* The anchor, with the new beginning of the log, is written first. So if the daemon is killed, one
 * file too many remains, and never one too few. */
int iso__audit_prune(struct iso_audit *audit, struct iso_fault *fault)
{
    const size_t keep = audit->options.segments > 0 ? (size_t)audit->options.segments : 0;
    const uint64_t before = audit->first;
    int error = 0;
    bool removed = false;
    if (audit->closed.n > keep && audit->options.segment_bytes > 0) {
        const size_t surplus = audit->closed.n - keep;
        const uint64_t first = surplus < audit->closed.n ? audit->closed.first[surplus]
                                                         : audit->segment_first;
        if (first > audit->first) {
            audit->first = first;
            error = iso__audit_write_anchor(audit, fault);
            audit->first = error ? before : first;
        }
    }
    while (!error && audit->closed.n > 0 && audit->closed.first[0] < audit->first) {
        error = remove_segment(audit, audit->closed.first[0], fault);
        if (!error) {
            forget_old(&audit->closed);
            removed = true;
        }
    }
    return error || !removed ? error : drop_keys(audit, fault);
}

/* Renames PATH to the name of a closed segment, and the new segment to PATH. A segment without a
 * record, left by a rotation that was killed, is overwritten. After an error, any of these steps
 * may have been done. */
static int exchange_files(struct iso_audit *audit, const char *beside, uint64_t first, bool empty,
                          struct iso_fault *fault)
{
    char closed[PATH_MAX];
    const int error = iso_audit_segment_path(audit->path, first, closed, fault);
    if (error) {
        return error;
    }
    if (!empty && renameat2(AT_FDCWD, audit->path, AT_FDCWD, closed, RENAME_NOREPLACE)) {
        return iso_storage_refused(closed, -errno, fault);
    }
    if (rename(beside, audit->path)) {
        return iso_storage_refused(audit->path, -errno, fault);
    }
    return iso_directory_sync(audit->path, fault);
}

/* The state of the present segment, which is restored if the next segment cannot begin. */
struct segment {
    struct iso_audit_seal seal;
    uint64_t first;
    off_t size;
    size_t n_marks;
};

static int begin_beside(struct iso_audit *audit, const char *beside, int *fd,
                        struct iso_fault *fault)
{
    int error = iso__audit_open_file(beside, O_TRUNC, fd, fault);
    if (!error) {
        error = iso__audit_begin_segment(audit, *fd, fault);
    }
    return error;
}

static int append_note(struct iso_audit *audit, uint64_t first, struct iso_fault *fault)
{
    struct iso_audit_record record = iso_audit_record_of("log-rotated");
    char note[96], latest[ISO_VALIDITY_DATE_SIZE];
    (void)snprintf(note, sizeof note,
                   "the segment before begins with record %" PRIu64 ", the log with %" PRIu64,
                   first, audit->first);
    record.note = note;
    if (audit->latest_s > 0) {
        /* The next start reads only the newest segment, so the date is repeated there. */
        record.before = iso_validity_date(audit->latest_s, latest);
    }
    if (audit->gallery[0]) {
        record.gallery = audit->gallery;
        record.gallery_changes = audit->gallery_changes;
    }
    return iso_audit_append(audit, &record, fault);
}

static void put_back(struct iso_audit *audit, const struct segment *segment)
{
    audit->seal = segment->seal;
    audit->segment_first = segment->first;
    audit->size = segment->size;
    audit->n_marks = segment->n_marks;
}

int iso__audit_rotate(struct iso_audit *audit, struct iso_fault *fault)
{
    const struct segment old = {audit->seal, audit->segment_first, audit->size, audit->n_marks};
    const bool empty = audit->last < old.first;
    char beside[PATH_MAX];
    int fd = -1;
    if (audit->closed.n == ISO_AUDIT_SEGMENTS_MAX ||
        snprintf(beside, sizeof beside, "%s.new", audit->path) >= PATH_MAX) {
        return iso_fault_set(fault, -EIO, "%s: no segment can be added", audit->path);
    }
    /* The header of a segment counts as a proof that the anchor was up to date. Therefore the
     * anchor is written first. */
    int error = iso__audit_catch_up(audit, fault);
    if (!error) {
        error = begin_beside(audit, beside, &fd, fault);
    }
    const bool begun = !error;
    if (!error) {
        error = exchange_files(audit, beside, old.first, empty, fault);
    }
    if (error) {
        put_back(audit, &old);
        if (fd >= 0) {
            (void)close(fd);
        }
        if (begun) {
            /* If this fails, it is tried again before the next record. */
            (void)!iso__audit_recover(audit, NULL);
        }
        (void)unlink(beside);
        return error;
    }
    (void)close(audit->fd);
    audit->fd = fd;
    if (!empty) {
        audit->closed.first[audit->closed.n++] = old.first;
    }
    error = iso__audit_prune(audit, fault);
    return error ? error : append_note(audit, old.first, fault);
}

int iso_audit_rotate_key(struct iso_audit *audit, struct iso_fault *fault)
{
    uint32_t number = 0;
    const int error = iso_key_ring_add(audit->options.ring, ISO_KEY_LOG, &number, fault);
    return error ? error : iso__audit_rotate(audit, fault);
}
