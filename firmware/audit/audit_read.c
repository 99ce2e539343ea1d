/* Reading the log: a few records, or all of them to check whether they are intact. */
#include <errno.h>
#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"
#include "firmware/audit/audit_state.h"

/* ---- a few ---- */

/* The sequence after the last record of closed segment i, or of the present segment if i ==
 * closed.n. */
static uint64_t segment_end(const struct iso_audit *audit, size_t i)
{
    if (i + 1 < audit->closed.n) {
        return audit->closed.first[i + 1];
    }
    return i < audit->closed.n ? audit->segment_first : audit->last + 1;
}

static int segment_path(const struct iso_audit *audit, size_t i, char path[PATH_MAX],
                        struct iso_fault *fault)
{
    if (i < audit->closed.n) {
        return iso_audit_segment_path(audit->path, audit->closed.first[i], path, fault);
    }
    (void)snprintf(path, PATH_MAX, "%s", audit->path);
    return 0;
}

/* Moves to record `from`. In the present segment the search starts at the nearest mark before it.
 */
static int seek_record(const struct iso_audit *audit, size_t i, struct iso_audit_reader *reader,
                       uint64_t from)
{
    if (i < audit->closed.n) {
        return iso_audit_reader_seek(reader, 0, 0, from);
    }
    const size_t mark = (size_t)((from - audit->segment_first) / ISO__AUDIT_MARK_LINES);
    return iso_audit_reader_seek(reader,
                                 audit->segment_first + (uint64_t)mark * ISO__AUDIT_MARK_LINES,
                                 audit->marks[mark], from);
}

/* Reads records of one segment, from *from up to, but without, `end`. */
static int read_segment(const struct iso_audit *audit, size_t i, struct iso_audit_reader *reader,
                        uint64_t *from, uint64_t end, int (*each)(void *context, const char *line),
                        void *context)
{
    char path[PATH_MAX];
    int result = segment_path(audit, i, path, NULL);
    if (!result) {
        result = iso_audit_reader_open(reader, path, audit->options.ring);
    }
    if (!result) {
        result = seek_record(audit, i, reader, *from);
    }
    while (!result && *from < end) {
        const int more = iso_audit_reader_next(reader);
        if (more <= 0) {
            result = more < 0 ? more : -EBADMSG;
        } else {
            (*from)++;
            result = each(context, reader->record.text);
        }
    }
    iso_audit_reader_close(reader);
    return result;
}

int iso_audit_read(struct iso_audit *audit, uint64_t from, uint32_t max,
                   int (*each)(void *context, const char *line), void *context)
{
    int result = audit->lost ? iso__audit_recover(audit, NULL) : 0;
    if (result) {
        return result;
    }
    from = from < audit->first ? audit->first : from;
    if (from > audit->last || max == 0) {
        return 0;
    }
    const uint64_t end = max < audit->last + 1 - from ? from + max : audit->last + 1;
    struct iso_audit_reader *reader = malloc(sizeof *reader);
    if (!reader) {
        return -ENOMEM;
    }
    for (size_t i = 0; !result && from < end && i <= audit->closed.n; i++) {
        const uint64_t segment = segment_end(audit, i);
        if (from < segment) {
            result = read_segment(audit, i, reader, &from, segment < end ? segment : end, each,
                                  context);
        }
    }
    free(reader);
    return result;
}

/* ---- all of them ---- */

struct verifying {
    const struct iso_audit *audit;
    struct iso_audit_reader reader;
    uint64_t next;              /* the expected sequence */
    struct iso_audit_link link; /* of the last record read */
    bool has_link;
    uint64_t known_sequence;
    const char *known_head; /* NULL: no head is given */
    const struct iso_work_listener *listener;
    struct iso_audit_report *report;
};

static void report_flaw(struct verifying *verifying, uint64_t at, const char *flaw)
{
    struct iso_audit_report *report = verifying->report;
    if (report->sound) {
        report->sound = false;
        report->flaw_at = at;
        (void)snprintf(report->flaw, sizeof report->flaw, "record %" PRIu64 " %s", at, flaw);
    }
}

static void check_known(struct verifying *verifying)
{
    char head[ISO_AUDIT_HEAD_SIZE];
    if (verifying->known_head && verifying->next - 1 == verifying->known_sequence) {
        (void)sodium_bin2hex(head, sizeof head, verifying->link.bytes,
                             sizeof verifying->link.bytes);
        if (strcmp(head, verifying->known_head) != 0) {
            report_flaw(verifying, verifying->known_sequence,
                        "does not have the head that is known");
        }
    }
}

/* Reports progress. After a fault, the present segment may hold more records than the log
 * counts. */
static void tell_record(const struct verifying *verifying)
{
    const struct iso_audit_report *report = verifying->report;
    if (verifying->next <= report->last + 1) {
        iso_work_step(verifying->listener, verifying->next - report->first,
                      report->last + 1 - report->first);
    }
}

/* Checks the records of one segment, which has to begin where the previous one ended. Returns 0, or
 * a negative errno such as -ENOMEM. Flaws go into the report. */
static int verify_segment(struct verifying *verifying, const char *path)
{
    struct iso_audit_reader *reader = &verifying->reader;
    int more = iso_audit_reader_open(reader, path, verifying->audit->options.ring);
    if (more == -ENOENT) {
        report_flaw(verifying, verifying->next, "and its whole segment are missing");
        return 0;
    }
    if (more == -EBADMSG) {
        report_flaw(verifying, verifying->next, reader->flaw);
        return 0;
    }
    if (more) {
        return more;
    }
    if (reader->header.first != verifying->next ||
        (verifying->has_link &&
         sodium_memcmp(&reader->header.link, &verifying->link, sizeof verifying->link) != 0)) {
        report_flaw(verifying, verifying->next, "is not the first of its segment, as it has to be");
        return 0;
    }
    verifying->link = reader->header.link;
    verifying->has_link = true;
    while ((more = iso_audit_reader_next(reader)) > 0) {
        verifying->link = reader->link;
        verifying->next = reader->next;
        check_known(verifying);
        tell_record(verifying);
    }
    if (more == -EBADMSG) {
        report_flaw(verifying, reader->next, reader->flaw);
    }
    return more == -EBADMSG ? 0 : more;
}

static int verify_segments(struct verifying *verifying, struct iso_fault *fault)
{
    const struct iso_audit *audit = verifying->audit;
    int error = 0;
    for (size_t i = 0; !error && verifying->report->sound && i <= audit->closed.n; i++) {
        char path[PATH_MAX];
        error = segment_path(audit, i, path, fault);
        if (!error && (error = verify_segment(verifying, path))) {
            error = iso_file_fault(path, error, fault);
        }
        iso_audit_reader_close(&verifying->reader);
    }
    return error;
}

/* Compares the end of the files with the end in memory, which was checked against the anchor. */
static void check_end(struct verifying *verifying)
{
    const struct iso_audit *audit = verifying->audit;
    if (!verifying->report->sound) {
        return;
    }
    if (verifying->next <= audit->last) {
        report_flaw(verifying, verifying->next, "and what came after it are missing");
    } else if (sodium_memcmp(&verifying->link, &audit->link, sizeof audit->link) != 0) {
        report_flaw(verifying, audit->last, "is not the last that was written");
    } else if (verifying->known_head && verifying->known_sequence > audit->last) {
        report_flaw(verifying, verifying->known_sequence,
                    "is missing, but its head is known: this is an old log");
    }
}

int iso_audit_verify(struct iso_audit *audit, uint64_t known_sequence, const char *known_head,
                     const struct iso_work_listener *listener, struct iso_audit_report *out,
                     struct iso_fault *fault)
{
    int error = iso__audit_settle(audit, fault);
    if (error) {
        return error;
    }
    struct iso_audit_report report = {.first = audit->first, .last = audit->last, .sound = true};
    struct verifying *verifying = malloc(sizeof *verifying);
    if (!verifying) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", audit->path);
    }
    *verifying = (struct verifying){.audit = audit,
                                    .next = audit->first,
                                    .known_sequence = known_sequence,
                                    .known_head = known_head,
                                    .listener = listener,
                                    .report = &report};
    (void)sodium_bin2hex(report.head, sizeof report.head, audit->link.bytes,
                         sizeof audit->link.bytes);
    error = verify_segments(verifying, fault);
    if (!error) {
        check_end(verifying);
        *out = report;
    }
    free(verifying);
    return error;
}
