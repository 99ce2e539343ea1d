#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"
#include "drivers/file/text.h"
#include "drivers/recording/recording.h"
#include "drivers/recording/recording_directory.h"

enum { CSV_BYTES_MAX = 64 << 20, COLUMNS = 5 };

static const char header[] = "frame,name,x_mm,y_mm,z_mm";

/* Fills in a row from a line. Returns NULL, or what is wrong with the line. */
static const char *parse_row(char *line, size_t n_frames, struct iso_recording_landmark *row)
{
    char *field[COLUMNS];
    if (iso_text_split(line, ',', field, COLUMNS) != COLUMNS) {
        return "not five fields";
    }
    if (iso_text_count(field[0], &row->frame) || row->frame >= n_frames) {
        return "no such frame";
    }
    if (!*field[1] || strlen(field[1]) >= sizeof row->name) {
        return "bad name";
    }
    (void)snprintf(row->name, sizeof row->name, "%s", field[1]);
    double *coordinate[3] = {&row->point_mm.x, &row->point_mm.y, &row->point_mm.z};
    for (int i = 0; i < 3; i++) {
        if (iso_text_number(field[2 + i], coordinate[i])) {
            return "bad coordinate";
        }
    }
    return NULL;
}

/* The rows of one frame are consecutive, so the search for a repeated row ends where the frame
 * begins. */
static bool is_repeated(const struct iso_recording_landmark *rows, size_t n)
{
    for (size_t i = n; i-- > 0 && rows[i].frame == rows[n].frame;) {
        if (strcmp(rows[i].name, rows[n].name) == 0) {
            return true;
        }
    }
    return false;
}

static int parse_rows(const char *path, char *text, size_t n_frames,
                      struct iso_recording_landmark **rows, size_t *n_rows, struct iso_fault *fault)
{
    struct iso_text_lines lines = iso_text_lines_of(text);
    char *line = iso_text_next_line(&lines);
    size_t n = 0, capacity = 0;
    if (!line || strcmp(line, header) != 0) {
        return iso_fault_set(fault, -EBADMSG, "%s:1: header is not `%s`", path, header);
    }
    while ((line = iso_text_next_line(&lines))) {
        if (n == capacity) {
            capacity = capacity ? 2 * capacity : 256;
            void *grown = reallocarray(*rows, capacity, sizeof **rows);
            if (!grown) {
                return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
            }
            *rows = grown;
        }
        const char *what = parse_row(line, n_frames, &(*rows)[n]);
        if (!what && n > 0 && (*rows)[n].frame < (*rows)[n - 1].frame) {
            what = "frames out of order";
        }
        if (!what && is_repeated(*rows, n)) {
            what = "repeated row";
        }
        if (what) {
            return iso_fault_set(fault, -EBADMSG, "%s:%u: %s", path, lines.number, what);
        }
        n++;
    }
    *n_rows = n;
    return 0;
}

int iso_recording_landmarks(const struct iso_recording *recording,
                            struct iso_recording_landmark **rows, size_t *n_rows,
                            struct iso_fault *fault)
{
    char path[PATH_MAX], *text = NULL;
    struct iso_recording_landmark *read = NULL;
    size_t n = 0;
    int error = iso_path_join(iso__recording_directory(recording), "landmarks.csv", path, fault);
    if (!error) {
        error = iso_text_read(path, CSV_BYTES_MAX, &text, fault);
    }
    if (!error) {
        error = parse_rows(path, text, iso_recording_frames(recording), &read, &n, fault);
    }
    free(text);
    if (error) {
        free(read);
        return error;
    }
    *rows = read;
    *n_rows = n;
    return 0;
}
