#include "firmware/audit/audit.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "core/base/bytes.h"
#include "drivers/file/directory.h"
#include "drivers/file/file.h"
#include "drivers/file/storage_fault.h"
#include "firmware/audit/audit_state.h"

/* ---- the anchor ---- */

static int make_anchor(struct iso_audit *audit, struct iso_fault *fault)
{
    const struct iso_anchor_state state = iso__audit_anchor_state(audit, false);
    return iso_anchor_make(audit->anchor_path, ISO__AUDIT_ANCHOR, audit->options.ring, true, &state,
                           &audit->anchor, fault);
}

/* ---- opening ---- */

int iso__audit_begin_segment(struct iso_audit *audit, int fd, struct iso_fault *fault)
{
    uint32_t number = iso_key_ring_newest(audit->options.ring, ISO_KEY_LOG);
    int error = number ? 0 : iso_key_ring_add(audit->options.ring, ISO_KEY_LOG, &number, fault);
    if (error) {
        return error;
    }
    const struct iso_audit_header header = {number, audit->last + 1, audit->link};
    const size_t length = iso_audit_header_put(&header, audit->line);
    const ssize_t written = write(fd, audit->line, length);
    if (written < 0) {
        error = -errno;
    } else if ((size_t)written < length) {
        error = -ENOSPC;
    } else {
        error = iso__audit_sync(audit, fd);
    }
    if (error) {
        return iso_storage_refused(audit->path, error, fault);
    }
    iso_audit_seal_wipe(&audit->seal);
    audit->seal = iso_audit_seal_of(number,
                                    iso_key_ring_find(audit->options.ring, ISO_KEY_LOG, number));
    audit->segment_first = header.first;
    audit->size = (off_t)length;
    audit->n_marks = 0;
    return 0;
}

/* Called when PATH is empty. Begins the log, or continues it after its newest closed segment. */
static int begin_log(struct iso_audit *audit, struct iso_fault *fault)
{
    size_t torn = 0;
    int error = 0;
    audit->first = 1;
    /* A header that was cut short may be in the file. */
    if (ftruncate(audit->fd, 0)) {
        return iso_storage_refused(audit->path, -errno, fault);
    }
    if (!audit->anchor && audit->closed.n > 0) {
        return iso__audit_stale(audit, ISO_FAULT_ANCHOR_DAMAGED, "its anchor is gone", fault);
    }
    if (audit->anchor && audit->closed.n > 0) {
        char path[PATH_MAX];
        error = iso_audit_segment_path(audit->path, audit->closed.first[audit->closed.n - 1], path,
                                       fault);
        if (!error) {
            error = iso__audit_scan(audit, path, &torn, fault);
        }
    }
    if (!error) {
        error = audit->anchor ? iso__audit_check_end(audit, true, fault)
                              : make_anchor(audit, fault);
    }
    return error ? error : iso__audit_begin_segment(audit, audit->fd, fault);
}

static int go_on(struct iso_audit *audit, size_t *torn, struct iso_fault *fault)
{
    if (!audit->anchor) {
        return iso__audit_stale(audit, ISO_FAULT_ANCHOR_DAMAGED, "its anchor is gone", fault);
    }
    const int error = iso__audit_scan(audit, audit->path, torn, fault);
    return error ? error : iso__audit_check_end(audit, false, fault);
}

/* Removes the part of a record that a crash has left. Writes a record of that if there is room. */
static int mend_end(struct iso_audit *audit, size_t torn, struct iso_fault *fault)
{
    char note[80];
    struct iso_audit_record record = iso_audit_record_of("log-recovered");
    if (torn == 0) {
        return 0;
    }
    if (ftruncate(audit->fd, audit->size)) {
        return iso_storage_refused(audit->path, -errno, fault);
    }
    (void)snprintf(note, sizeof note, "%zu bytes of an unfinished record were removed", torn);
    record.note = note;
    const int error = iso_audit_append(audit, &record, fault);
    return error == -ENOSPC ? 0 : error;
}

int iso__audit_open_file(const char *path, int flags, int *fd, struct iso_fault *fault)
{
    int opened = -1;
    const int failed = iso_file_open(path, O_RDWR | O_APPEND | O_CREAT | flags, ISO_FILE_ANY_SIZE,
                                     &opened, fault);
    if (failed) {
        return iso_storage_reword(path, failed, fault);
    }
    if (flock(opened, LOCK_EX | LOCK_NB)) {
        const int error = errno == EWOULDBLOCK ? -EBUSY : -errno;
        (void)close(opened);
        return iso_fault_set_code(fault, error == -EBUSY ? ISO_FAULT_STORE_BUSY : ISO_FAULT_NONE,
                                  error, "%s: %s", path,
                                  error == -EBUSY ? "another process writes it" : strerror(-error));
    }
    *fd = opened;
    return 0;
}

enum content { EMPTY, PLAIN, SEALED };

/* Examines the file PATH. A header without its end counts as an empty file. */
static int look_at_content(const struct iso_audit *audit, enum content *out,
                           struct iso_fault *fault)
{
    char begin[ISO_AUDIT_LINE_MAX];
    const ssize_t n = pread(audit->fd, begin, sizeof begin, 0);
    if (n < 0) {
        return iso_storage_refused(audit->path, -errno, fault);
    }
    if (n > 0 && begin[0] == '{') {
        *out = PLAIN;
    } else if (n == 0 || (n < (ssize_t)sizeof begin && !memchr(begin, '\n', (size_t)n))) {
        *out = EMPTY;
    } else {
        *out = SEALED;
    }
    return 0;
}

static int open_log(struct iso_audit *audit, struct iso_fault *fault)
{
    enum content content = EMPTY;
    size_t torn = 0;
    int error = iso__audit_open_file(audit->path, 0, &audit->fd, fault);
    if (!error) {
        error = iso_directory_sync(audit->path, fault);
    }
    if (!error) {
        error = iso_anchor_open(audit->anchor_path, ISO__AUDIT_ANCHOR, audit->options.ring, true,
                                &audit->anchor, fault);
        error = error == -ENOENT ? 0 : error;
    }
    if (!error) {
        iso__audit_tell_anchor(audit);
    }
    if (!error) {
        error = iso_audit_segments_find(audit->path, &audit->closed, fault);
    }
    if (!error) {
        error = look_at_content(audit, &content, fault);
    }
    if (!error && content == PLAIN) {
        error = iso__audit_migrate(audit, fault);
    } else if (!error) {
        error = content == EMPTY ? begin_log(audit, fault) : go_on(audit, &torn, fault);
    }
    if (!error) {
        error = iso__audit_prune(audit, fault);
    }
    return error ? error : mend_end(audit, torn, fault);
}

int iso_audit_open(const struct iso_audit_options *options, const struct iso_times *times,
                   struct iso_audit **out, struct iso_fault *fault)
{
    struct iso_audit *audit = calloc(1, sizeof *audit);
    if (!audit || !(audit->path = strdup(options->path)) ||
        asprintf(&audit->anchor_path, "%s.anchor", options->path) < 0) {
        free(audit ? audit->path : NULL);
        free(audit);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", options->path);
    }
    audit->fd = -1;
    audit->options = *options;
    audit->options.path = audit->path;
    audit->times = times;
    const int error = open_log(audit, fault);
    if (error) {
        iso_audit_close(audit);
        return error;
    }
    audit->opened = true;
    *out = audit;
    return 0;
}

void iso_audit_close(struct iso_audit *audit)
{
    if (audit) {
        if (audit->opened && !audit->lost &&
            (audit->last > iso_anchor_state(audit->anchor)->value ||
             iso__audit_wants_number(audit))) {
            (void)!iso__audit_write_anchor(audit, NULL);
        }
        if (audit->fd >= 0) {
            (void)close(audit->fd);
        }
        iso_anchor_close(audit->anchor);
        free(audit->marks);
        free(audit->path);
        free(audit->anchor_path);
        sodium_memzero(audit, sizeof *audit);
        free(audit);
    }
}

/* ---- what is known ---- */

uint64_t iso_audit_last(const struct iso_audit *audit)
{
    return audit->last;
}

uint64_t iso_audit_first(const struct iso_audit *audit)
{
    return audit->first;
}

uint64_t iso_audit_gallery_changes(const struct iso_audit *audit, const char *gallery)
{
    return strcmp(audit->gallery, gallery) == 0 ? audit->gallery_changes : 0;
}

int iso_audit_renew_anchor(struct iso_audit *audit, struct iso_fault *fault)
{
    const int error = iso__audit_write_anchor(audit, fault);
    /* The second write fills the other slot. */
    return error ? error : iso__audit_write_anchor(audit, fault);
}
