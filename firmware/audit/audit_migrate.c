/* Seals a log of the previous version: the same records, which were JSON objects in plain text, one
 * in each line.
 *
 * This is done once, while no part of the log of this appliance is sealed. The records keep their
 * sequences, and a record after them says that they were not sealed before. First the anchor notes
 * that sealing is under way. If the daemon is killed, it finds either the old file, and begins the
 * sealing again, or the new one. */
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/file/data_file.h"
#include "drivers/file/directory.h"
#include "drivers/file/disk_wait.h"
#include "drivers/file/file.h"
#include "firmware/audit/audit_state.h"

static int may_migrate(const struct iso_audit *audit, struct iso_fault *fault)
{
    const bool first = !audit->anchor && audit->closed.n == 0 &&
                       iso_key_ring_newest(audit->options.ring, ISO_KEY_LOG) == 0;
    if (audit->options.migrate && (first || iso__audit_anchor_is_sealing(audit))) {
        return 0;
    }
    return iso_fault_set_code(
        fault, ISO_FAULT_STORE_UNSEALED, -ESTALE, "%s: a log in plain text, %s", audit->path,
        audit->options.migrate ? "where there was a sealed one"
                               : "and [seal] migrate = no does not accept it");
}

static int set_anchor(struct iso_audit *audit, struct iso_fault *fault)
{
    const struct iso_anchor_state state = iso__audit_anchor_state(audit, true);
    return audit->anchor
               ? iso_anchor_set(audit->anchor, &state, fault)
               : iso_anchor_make(audit->anchor_path, ISO__AUDIT_ANCHOR, audit->options.ring, true,
                                 &state, &audit->anchor, fault);
}

/* Whether a line is the expected next record with its newline. A line that is too long, or that
 * contains a NUL, was read without its newline. */
static bool is_next(const struct iso_audit *audit, const char *line, size_t length)
{
    char begin[40];
    const int n = snprintf(begin, sizeof begin, "{\"sequence\":%" PRIu64 ",", audit->last + 1);
    return length > (size_t)n + 2 && length <= ISO_AUDIT_TEXT_MAX &&
           memcmp(line, begin, (size_t)n) == 0 && line[length - 2] == '}' &&
           line[length - 1] == '\n';
}

static int seal_line(struct iso_audit *audit, FILE *out, const char *line, size_t length,
                     struct iso_fault *fault)
{
    if (!is_next(audit, line, length)) {
        return iso_fault_set_code(fault, ISO_FAULT_LOG_DAMAGED, -EBADMSG,
                                  "%s:%" PRIu64 ": damaged, or not record %" PRIu64
                                  "; move the file away to begin a new log",
                                  audit->path, audit->last + 1, audit->last + 1);
    }
    if (iso__audit_reserve_mark(audit)) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", audit->path);
    }
    struct iso_heads known = iso_heads_now(iso_key_ring_board(audit->options.ring));
    known.count[ISO_HEAD_LOG] = 0; /* the anchor is written after all these records */
    const size_t sealed = iso_audit_line_close(&audit->seal, audit->last + 1, &known, line,
                                               length - 1, audit->line, &audit->link);
    if (fwrite(audit->line, 1, sealed, out) != sealed) {
        return iso_fault_set_code(fault, ISO_FAULT_DISK_FULL, -ENOSPC, "%s: %m", audit->path);
    }
    iso__audit_count_line(audit, sealed);
    return 0;
}

static int seal_lines(struct iso_audit *audit, FILE *in, FILE *out, struct iso_fault *fault)
{
    char line[ISO_AUDIT_TEXT_MAX + 2]; /* a longer line is not a record */
    int error = 0;
    while (!error && fgets(line, sizeof line, in)) {
        const size_t length = strlen(line);
        if (feof(in)) {
            break; /* a crash has cut this record short */
        }
        error = seal_line(audit, out, line, length, fault);
    }
    if (!error && ferror(in)) {
        error = iso_fault_set_code(fault, ISO_FAULT_DISK_FAILED, -EIO, "%s: cannot be read",
                                   audit->path);
    }
    return error;
}

/* Opens both files as streams; `fd` stays open. */
static int seal_file(struct iso_audit *audit, int fd, struct iso_fault *fault)
{
    FILE *in = NULL;
    int error = iso_file_stream(audit->path, ISO_FILE_ANY_SIZE, &in, fault);
    const int copy = dup(fd);
    FILE *out = copy >= 0 ? fdopen(copy, "a") : NULL;
    if (!error && !out) {
        error = iso_fault_set(fault, -ENOMEM, "%s: %m", audit->path);
    }
    if (!error) {
        error = seal_lines(audit, in, out, fault);
    }
    if (out && (fflush(out) || iso_disk_wait_fsync(fd)) && !error) {
        error = iso_fault_set_code(
            fault, errno == ENOSPC || errno == EFBIG ? ISO_FAULT_DISK_FULL : ISO_FAULT_DISK_FAILED,
            errno == ENOSPC || errno == EFBIG ? -ENOSPC : -EIO, "%s: %m", audit->path);
    }
    if (out) {
        (void)fclose(out);
    } else if (copy >= 0) {
        (void)close(copy);
    }
    if (in) {
        (void)fclose(in);
    }
    return error;
}

static int move_in(struct iso_audit *audit, const char *beside, int fd, struct iso_fault *fault)
{
    int error = set_anchor(audit, fault);
    if (!error && rename(beside, audit->path)) {
        error = iso_file_fault(audit->path, -errno, fault);
    }
    if (!error) {
        error = iso_directory_sync(audit->path, fault);
    }
    if (!error) {
        iso_data_file_overwrite(audit->fd);
        (void)close(audit->fd);
        audit->fd = fd;
        error = iso__audit_write_anchor(audit, fault);
    }
    return error;
}

static int say_so(struct iso_audit *audit, struct iso_fault *fault)
{
    struct iso_audit_record record = iso_audit_record_of("log-sealed");
    char note[80];
    (void)snprintf(note, sizeof note, "records to %" PRIu64 " were not protected until now",
                   audit->last);
    record.note = note;
    const int error = iso_audit_append(audit, &record, fault);
    return error == -ENOSPC ? 0 : error;
}

int iso__audit_migrate(struct iso_audit *audit, struct iso_fault *fault)
{
    char beside[PATH_MAX];
    int fd = -1;
    if (snprintf(beside, sizeof beside, "%s.new", audit->path) >= PATH_MAX) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", audit->path);
    }
    int error = may_migrate(audit, fault);
    audit->first = 1;
    if (!error) {
        error = set_anchor(audit, fault);
    }
    if (!error) {
        error = iso__audit_open_file(beside, O_TRUNC, &fd, fault);
    }
    if (!error) {
        error = iso__audit_begin_segment(audit, fd, fault);
    }
    if (!error) {
        error = seal_file(audit, fd, fault);
    }
    if (!error) {
        error = move_in(audit, beside, fd, fault);
    }
    if (error) {
        if (fd >= 0 && fd != audit->fd) {
            (void)close(fd);
            (void)unlink(beside);
        }
        return error;
    }
    return say_so(audit, fault);
}
