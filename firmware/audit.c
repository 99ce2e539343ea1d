#include "firmware/audit.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <time.h>
#include <unistd.h>

#include "firmware/directory.h"
#include "firmware/json_line.h"

/* Every so many lines the place of one is remembered, so that reading need not begin at the first.
 */
enum { MARK_LINES = 256, LINE_MAX_BYTES = sizeof((struct iso_json_line *)0)->text };

struct iso_audit {
    int fd;
    char *path;
    bool sync;
    const struct iso_times *times;
    uint64_t last; /* sequence of the last record */
    off_t size;    /* of the whole lines */
    bool torn;     /* part of a record may stand behind them */
    off_t *marks;  /* marks[i]: where the line of sequence 1 + i * MARK_LINES begins */
    size_t n_marks, mark_capacity;
    struct iso_json_line line;
};

struct iso_audit_record iso_audit_record_of(const char *event)
{
    return (struct iso_audit_record){
        .event = event,
        .score = NAN,
        .threshold = NAN,
        .frames = -1,
        .attack_frames = -1,
    };
}

/* ---- where the lines are ---- */

/* Makes room for the mark of the record that comes next, if it is to have one. */
static int reserve_mark(struct iso_audit *audit)
{
    if (audit->last % MARK_LINES != 0 || audit->n_marks < audit->mark_capacity) {
        return 0;
    }
    const size_t capacity = audit->mark_capacity ? 2 * audit->mark_capacity : 16;
    off_t *grown = reallocarray(audit->marks, capacity, sizeof *grown);
    if (!grown) {
        return -ENOMEM;
    }
    audit->marks = grown;
    audit->mark_capacity = capacity;
    return 0;
}

static void count_line(struct iso_audit *audit, size_t bytes)
{
    if (audit->last % MARK_LINES == 0) {
        audit->marks[audit->n_marks++] = audit->size;
    }
    audit->last++;
    audit->size += (off_t)bytes;
}

/* ---- opening ---- */

static int damaged(const struct iso_audit *audit, struct iso_fault *fault)
{
    return iso_fault_set(fault, -EBADMSG,
                         "%s:%" PRIu64 ": damaged, or not record %" PRIu64
                         "; move the file away to begin a new log",
                         audit->path, audit->last + 1, audit->last + 1);
}

/* Whether a line is the record that has to come next. */
static bool is_next(const struct iso_audit *audit, const char *line, size_t length)
{
    char begin[40];
    const int n = snprintf(begin, sizeof begin, "{\"sequence\":%" PRIu64 ",", audit->last + 1);
    return length > (size_t)n + 2 && memcmp(line, begin, (size_t)n) == 0 &&
           line[length - 2] == '}' && !memchr(line, '\0', length);
}

/* Goes over all lines. *torn is how many bytes stand behind the last whole one. */
static int scan(struct iso_audit *audit, FILE *file, size_t *torn, struct iso_fault *fault)
{
    char *line = NULL;
    size_t capacity = 0;
    ssize_t length;
    int error = 0;
    *torn = 0;
    while (!error && (length = getline(&line, &capacity, file)) > 0) {
        if (line[length - 1] != '\n') {
            *torn = (size_t)length;
            break;
        }
        if (!is_next(audit, line, (size_t)length)) {
            error = damaged(audit, fault);
        } else if (reserve_mark(audit)) {
            error = iso_fault_set(fault, -ENOMEM, "%s: out of memory", audit->path);
        } else {
            count_line(audit, (size_t)length);
        }
    }
    if (!error && ferror(file)) {
        error = iso_fault_set(fault, -EIO, "%s: cannot be read", audit->path);
    }
    free(line);
    return error;
}

static int scan_file(struct iso_audit *audit, size_t *torn, struct iso_fault *fault)
{
    FILE *file = fopen(audit->path, "re");
    if (!file) {
        return iso_fault_set(fault, -errno, "%s: %m", audit->path);
    }
    const int error = scan(audit, file, torn, fault);
    (void)fclose(file);
    return error;
}

/* Takes away what a crash left of a record, and says so on record if there is room. */
static int mend(struct iso_audit *audit, size_t torn, struct iso_fault *fault)
{
    char note[80];
    struct iso_audit_record record = iso_audit_record_of("log-recovered");
    if (torn == 0) {
        return 0;
    }
    if (ftruncate(audit->fd, audit->size)) {
        return iso_fault_set(fault, -errno, "%s: %m", audit->path);
    }
    (void)snprintf(note, sizeof note, "%zu bytes of an unfinished record taken away", torn);
    record.note = note;
    const int error = iso_audit_append(audit, &record, fault);
    return error == -ENOSPC ? 0 : error;
}

static int open_file(struct iso_audit *audit, struct iso_fault *fault)
{
    audit->fd = open(audit->path, O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC | O_NOCTTY, 0600);
    if (audit->fd < 0) {
        return iso_fault_set(fault, -errno, "%s: %m", audit->path);
    }
    if (flock(audit->fd, LOCK_EX | LOCK_NB)) {
        const int error = errno == EWOULDBLOCK ? -EBUSY : -errno;
        return iso_fault_set(fault, error, "%s: %s", audit->path,
                             error == -EBUSY ? "another process writes it" : strerror(-error));
    }
    return iso_directory_sync(audit->path, fault);
}

int iso_audit_open(const char *path, bool sync, const struct iso_times *times,
                   struct iso_audit **out, struct iso_fault *fault)
{
    size_t torn = 0;
    struct iso_audit *audit = calloc(1, sizeof *audit);
    if (!audit || !(audit->path = strdup(path))) {
        free(audit);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    audit->fd = -1;
    audit->sync = sync;
    audit->times = times;
    int error = open_file(audit, fault);
    if (!error) {
        error = scan_file(audit, &torn, fault);
    }
    if (!error) {
        error = mend(audit, torn, fault);
    }
    if (error) {
        iso_audit_close(audit);
        return error;
    }
    *out = audit;
    return 0;
}

void iso_audit_close(struct iso_audit *audit)
{
    if (audit) {
        if (audit->fd >= 0) {
            (void)close(audit->fd);
        }
        free(audit->marks);
        free(audit->path);
        free(audit);
    }
}

/* ---- writing ---- */

static void format_time(int64_t wall_ns, char text[40])
{
    const time_t seconds = (time_t)(wall_ns / ISO_NS_PER_S);
    struct tm utc;
    char date[24] = "1970-01-01T00:00:00";
    if (wall_ns >= 0 && gmtime_r(&seconds, &utc)) {
        (void)strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%S", &utc);
    }
    (void)snprintf(text, 40, "%s.%03dZ", date,
                   wall_ns >= 0 ? (int)(wall_ns / ISO_NS_PER_MS % 1000) : 0);
}

static void add_string(struct iso_json_line *line, const char *key, const char *value)
{
    if (value) {
        iso_json_line_string(line, key, value);
    }
}

static size_t format(struct iso_audit *audit, const struct iso_audit_record *record)
{
    struct iso_json_line *line = &audit->line;
    char time[40];
    format_time(iso_times_wall_ns(audit->times), time);
    iso_json_line_begin(line);
    iso_json_line_integer(line, "sequence", (int64_t)(audit->last + 1));
    iso_json_line_string(line, "time", time);
    iso_json_line_integer(line, "monotonic_ns", iso_times_now_ns(audit->times));
    iso_json_line_string(line, "event", record->event);
    add_string(line, "person", record->person);
    add_string(line, "verdict", record->verdict);
    add_string(line, "reason", record->reason);
    if (!isnan(record->score)) {
        iso_json_line_number(line, "score", record->score);
    }
    if (!isnan(record->threshold)) {
        iso_json_line_number(line, "threshold", record->threshold);
    }
    if (record->frames >= 0) {
        iso_json_line_integer(line, "frames", record->frames);
    }
    if (record->attack_frames >= 0) {
        iso_json_line_integer(line, "attack_frames", record->attack_frames);
    }
    add_string(line, "note", record->note);
    return iso_json_line_end(line);
}

/* Takes away what a failed write left, so that the next record begins a line. */
static int take_back(struct iso_audit *audit)
{
    audit->torn = ftruncate(audit->fd, audit->size) != 0;
    return audit->torn ? -EIO : 0;
}

/* 0 with the line on the disk, else a negative errno with nothing or a part of it there. */
static int write_line(struct iso_audit *audit, size_t length)
{
    const ssize_t written = write(audit->fd, audit->line.text, length);
    if (written < 0) {
        /* A limit on the file's size or the user's quota is a full disk to us. */
        return errno == EFBIG || errno == EDQUOT ? -ENOSPC : -errno;
    }
    if ((size_t)written < length) {
        return -ENOSPC;
    }
    return audit->sync && fdatasync(audit->fd) ? -errno : 0;
}

int iso_audit_append(struct iso_audit *audit, const struct iso_audit_record *record,
                     struct iso_fault *fault)
{
    const size_t length = format(audit, record);
    if (length == 0) {
        return iso_fault_set(fault, -EINVAL, "%s: the record is too long", audit->path);
    }
    int error = audit->torn ? take_back(audit) : 0;
    if (!error) {
        error = reserve_mark(audit);
    }
    if (!error && (error = write_line(audit, length))) {
        (void)take_back(audit);
    }
    if (error) {
        error = error == -ENOSPC || error == -ENOMEM ? error : -EIO;
        return iso_fault_set(fault, error, "%s: the record cannot be written: %s", audit->path,
                             strerror(-error));
    }
    count_line(audit, length);
    return 0;
}

/* ---- reading ---- */

uint64_t iso_audit_last(const struct iso_audit *audit)
{
    return audit->last;
}

/* Reads lines from the mark before `from` on. */
static int read_lines(const struct iso_audit *audit, FILE *file, uint64_t from, uint32_t max,
                      int (*each)(void *context, const char *line), void *context)
{
    char line[LINE_MAX_BYTES];
    const size_t mark = (size_t)((from - 1) / MARK_LINES);
    uint64_t sequence = 1 + (uint64_t)mark * MARK_LINES;
    if (fseeko(file, audit->marks[mark], SEEK_SET)) {
        return -EIO;
    }
    for (; sequence <= audit->last && (sequence < from || sequence - from < max); sequence++) {
        if (!fgets(line, sizeof line, file)) {
            return -EIO;
        }
        line[strcspn(line, "\n")] = '\0';
        const int result = sequence < from ? 0 : each(context, line);
        if (result) {
            return result;
        }
    }
    return 0;
}

int iso_audit_read(struct iso_audit *audit, uint64_t from, uint32_t max,
                   int (*each)(void *context, const char *line), void *context)
{
    if (from == 0) {
        from = 1;
    }
    if (from > audit->last || max == 0) {
        return 0;
    }
    FILE *file = fopen(audit->path, "re");
    if (!file) {
        return -EIO;
    }
    const int result = read_lines(audit, file, from, max, each, context);
    (void)fclose(file);
    return result;
}
