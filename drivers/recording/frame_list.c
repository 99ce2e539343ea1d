#include "drivers/recording/frame_list.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/text.h"

enum { LIST_BYTES_MAX = 64 << 20, SECONDS_DIGITS_MAX = 10 };

/* Converts decimal seconds to nanoseconds exactly. A double would lose digits of times that count
 * from 1970. Digits after the ninth decimal are dropped. */
static int parse_seconds(const char *text, int64_t *t_ns)
{
    const size_t digits = strspn(text, "0123456789");
    if (digits < 1 || digits > SECONDS_DIGITS_MAX) {
        return -EINVAL;
    }
    const long long seconds = strtoll(text, NULL, 10);
    if (seconds >= INT64_MAX / 1000000000) {
        return -EINVAL;
    }
    int64_t value_ns = seconds * 1000000000;
    const char *decimals = text + digits;
    if (*decimals == '.') {
        int64_t unit_ns = 100000000;
        for (decimals++; *decimals >= '0' && *decimals <= '9'; decimals++, unit_ns /= 10) {
            value_ns += (*decimals - '0') * unit_ns;
        }
    }
    if (*decimals) {
        return -EINVAL;
    }
    *t_ns = value_ns;
    return 0;
}

/* A recording may name only files of its own directory. */
static bool is_inside(const char *file)
{
    if (*file == '/') {
        return false;
    }
    for (size_t length;; file += length + 1) {
        length = strcspn(file, "/");
        if (length == 2 && strncmp(file, "..", 2) == 0) {
            return false;
        }
        if (file[length] == '\0') {
            return true;
        }
    }
}

/* Cuts "timestamp file" into its parts. Returns false if the line has another form. */
static bool parse_line(char *line, struct iso_frame_entry *entry)
{
    char *blank = line + strcspn(line, " \t");
    char *file = blank + strspn(blank, " \t");
    char *end = file + strcspn(file, " \t");
    if (file == end || end[strspn(end, " \t")]) {
        return false;
    }
    *blank = '\0';
    *end = '\0';
    entry->file = file;
    return parse_seconds(line, &entry->t_ns) == 0;
}

static int parse_lines(const char *path, struct iso_frame_list *list, struct iso_fault *fault)
{
    struct iso_text_lines lines = iso_text_lines_of(list->text);
    for (char *line; (line = iso_text_next_line(&lines));) {
        struct iso_frame_entry *entry = &list->entries[list->n];
        if (*line == '#' || *line == '\0') {
            continue;
        }
        if (!parse_line(line, entry)) {
            return iso_fault_set(fault, -EBADMSG, "%s:%u: not `timestamp_s filename`", path,
                                 lines.number);
        }
        if (!is_inside(entry->file)) {
            return iso_fault_set(fault, -EBADMSG, "%s:%u: file '%s' is not inside the recording",
                                 path, lines.number, entry->file);
        }
        if (list->n > 0 && entry->t_ns <= entry[-1].t_ns) {
            return iso_fault_set(fault, -EBADMSG, "%s:%u: time does not rise", path, lines.number);
        }
        list->n++;
    }
    return list->n ? 0 : iso_fault_set(fault, -EBADMSG, "%s: no frames", path);
}

int iso__frame_list_read(const char *path, struct iso_frame_list *out, struct iso_fault *fault)
{
    struct iso_frame_list list = {0};
    int error = iso_text_read(path, LIST_BYTES_MAX, &list.text, fault);
    if (error) {
        return error;
    }
    list.entries = calloc(iso_text_line_count(list.text), sizeof *list.entries);
    error = list.entries ? parse_lines(path, &list, fault)
                         : iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    if (error) {
        iso__frame_list_done(&list);
        return error;
    }
    *out = list;
    return 0;
}

void iso__frame_list_done(struct iso_frame_list *list)
{
    free(list->entries);
    free(list->text);
    *list = (struct iso_frame_list){0};
}
