#include "firmware/audit/audit_segment.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"

enum { DIGITS = 20 };

int iso_audit_segment_path(const char *path, uint64_t first, char out[PATH_MAX],
                           struct iso_fault *fault)
{
    return snprintf(out, PATH_MAX, "%s.%0*" PRIu64, path, DIGITS, first) < PATH_MAX
               ? 0
               : iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", path);
}

/* ---- the closed segments ---- */

/* The first sequence in a file name such as "audit.log.00000000000000000001"; 0 if there is
 * none. */
static uint64_t first_of(const char *name, const char *base)
{
    const size_t length = strlen(base);
    if (strlen(name) != length + 1 + DIGITS || memcmp(name, base, length) != 0 ||
        name[length] != '.') {
        return 0;
    }
    for (size_t i = length + 1; name[i]; i++) {
        if (!isdigit((unsigned char)name[i])) {
            return 0;
        }
    }
    return strtoull(name + length + 1, NULL, 10);
}

static int insert_segment(struct iso_audit_segments *segments, uint64_t first)
{
    size_t at = segments->n;
    if (segments->n == ISO_AUDIT_SEGMENTS_MAX) {
        return -E2BIG;
    }
    while (at > 0 && segments->first[at - 1] > first) {
        segments->first[at] = segments->first[at - 1];
        at--;
    }
    segments->first[at] = first;
    segments->n++;
    return 0;
}

int iso_audit_segments_find(const char *path, struct iso_audit_segments *out,
                            struct iso_fault *fault)
{
    struct iso_audit_segments segments = {0};
    char directory[PATH_MAX];
    const struct dirent *entry;
    const char *slash = strrchr(path, '/');
    const char *base = slash ? slash + 1 : path;
    int error = 0;
    (void)snprintf(directory, sizeof directory, "%.*s", slash ? (int)(slash - path + 1) : 1,
                   slash ? path : ".");
    DIR *stream = opendir(directory);
    if (!stream) {
        return iso_file_fault(directory, -errno, fault);
    }
    while (!error && (entry = readdir(stream))) {
        const uint64_t first = first_of(entry->d_name, base);
        error = first ? insert_segment(&segments, first) : 0;
    }
    (void)closedir(stream);
    if (error) {
        return iso_fault_set(fault, error, "%s: more than %d old segments", path,
                             ISO_AUDIT_SEGMENTS_MAX);
    }
    *out = segments;
    return 0;
}

/* ---- reading one ---- */

/* Reads one line without its newline. Returns its length, -ENODATA at the end (and sets `torn` to
 * the length of an incomplete line), -EIO, or -EBADMSG for a line that is too long. */
static ssize_t read_line(struct iso_audit_reader *reader)
{
    if (!fgets(reader->line, sizeof reader->line, reader->file)) {
        return ferror(reader->file) ? -EIO : -ENODATA;
    }
    const size_t length = strlen(reader->line);
    if (length > 0 && reader->line[length - 1] == '\n') {
        reader->line[length - 1] = '\0';
        reader->position += (off_t)length;
        return (ssize_t)(length - 1);
    }
    if (!feof(reader->file)) {
        reader->flaw = "is no record";
        return -EBADMSG;
    }
    reader->torn = length;
    return -ENODATA;
}

/* Describes a file of a wrong type in the place of the segment. NULL: the error has another
 * cause. */
static const char *flaw_of(int error)
{
    switch (error) {
    case -EISDIR:
        return "cannot be read: a directory is in the place of its file";
    case -ELOOP:
        return "cannot be read: a symbolic link is in the place of its file";
    case -EMEDIUMTYPE:
        return "cannot be read: a FIFO, a socket or a device is in the place of its file";
    default:
        return NULL;
    }
}

int iso_audit_reader_open(struct iso_audit_reader *reader, const char *path,
                          const struct iso_key_ring *ring)
{
    memset(reader, 0, sizeof *reader);
    const int error = iso_file_stream(path, ISO_FILE_ANY_SIZE, &reader->file, NULL);
    if (error) {
        reader->flaw = flaw_of(error);
        return reader->flaw ? -EBADMSG : error;
    }
    const ssize_t length = read_line(reader);
    if (length == -EIO) {
        return -EIO;
    }
    reader->flaw = "has no header that is sound";
    if (length < 0 || iso_audit_header_get(reader->line, &reader->header)) {
        return -EBADMSG;
    }
    const struct iso_seal_key *key = iso_key_ring_find(ring, ISO_KEY_LOG,
                                                       reader->header.key_number);
    if (!key) {
        reader->flaw = "is sealed with a key that is not in the key ring";
        return -EBADMSG;
    }
    reader->flaw = NULL;
    reader->seal = iso_audit_seal_of(reader->header.key_number, key);
    reader->next = reader->header.first;
    reader->link = reader->header.link;
    return 0;
}

void iso_audit_reader_close(struct iso_audit_reader *reader)
{
    if (reader->file) {
        (void)fclose(reader->file);
    }
    sodium_memzero(reader, sizeof *reader);
}

int iso_audit_reader_next(struct iso_audit_reader *reader)
{
    const ssize_t length = read_line(reader);
    if (length == -ENODATA) {
        return 0;
    }
    if (length < 0) {
        return (int)length;
    }
    if (iso_audit_line_open(&reader->seal, reader->next, reader->line, (size_t)length,
                            &reader->record)) {
        reader->flaw = "was changed, or is not where it belongs";
        return -EBADMSG;
    }
    if (!reader->sought &&
        sodium_memcmp(&reader->record.before, &reader->link, sizeof reader->link) != 0) {
        reader->flaw = "does not follow from the one before it";
        return -EBADMSG;
    }
    reader->sought = false;
    reader->link = reader->record.behind;
    reader->next++;
    return 1;
}

int iso_audit_reader_seek(struct iso_audit_reader *reader, uint64_t at, off_t position,
                          uint64_t sequence)
{
    if (position > 0 && fseeko(reader->file, position, SEEK_SET)) {
        return -EIO;
    }
    if (position > 0) {
        reader->position = position;
    }
    reader->sought = true;
    reader->next = position > 0 ? at : reader->header.first;
    while (reader->next < sequence) {
        if (read_line(reader) < 0) {
            return -EIO;
        }
        reader->next++;
    }
    return 0;
}
