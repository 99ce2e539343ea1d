#include "sim/corpus/corpus.h"

#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/base/path.h"
#include "drivers/file/text.h"
#include "drivers/recording/recording.h"

enum { MANIFEST_BYTES_MAX = 64 << 20, COLUMNS = 9 };

static const char header[] = "recording,first,count,subject,session,role,pose,expression,note";
static const char *const column_names[COLUMNS] = {
    "recording", "first", "count", "subject", "session", "role", "pose", "expression", "note",
};

const char *sim_role_name(enum sim_role role)
{
    static const char *const names[SIM_ROLES] = {"gallery", "probe", "impostor"};
    return (unsigned)role < SIM_ROLES ? names[role] : NULL;
}

/* ---- one row ---------------------------------------------------------------- */

static bool is_word(const char *word)
{
    for (int i = 0; i < SIM_CORPUS_NAME_MAX; i++) {
        unsigned char c = (unsigned char)word[i];
        if (c == '\0') {
            return true;
        }
        if (c < ' ' || c == 127 || c == ',' || c == '"') {
            return false;
        }
    }
    return false; /* too long, or not ended */
}

static bool is_recording_name(const char *name)
{
    return *name && *name != '.' && !strchr(name, '/');
}

/* An invalid column of a row, or -1. */
static int unsound_column(const struct sim_corpus_row *row)
{
    const char *const words[COLUMNS] = {
        [0] = row->recording, [3] = row->subject,    [4] = row->session,
        [6] = row->pose,      [7] = row->expression, [8] = row->note};
    for (int i = 0; i < COLUMNS; i++) {
        if (words[i] && !is_word(words[i])) {
            return i;
        }
    }
    if (!is_recording_name(row->recording)) {
        return 0;
    }
    if (row->count < 1) {
        return 2;
    }
    if (!*row->subject) {
        return 3;
    }
    return (unsigned)row->role < SIM_ROLES ? -1 : 5;
}

static enum sim_role role_of(const char *word)
{
    int role = 0;
    while (role < SIM_ROLES && strcmp(word, sim_role_name((enum sim_role)role)) != 0) {
        role++;
    }
    return (enum sim_role)role;
}

/* Fills in a row. Returns an invalid column, or -1. */
static int fill_row(char *const field[COLUMNS], struct sim_corpus_row *row)
{
    char *const words[COLUMNS] = {[0] = row->recording, [3] = row->subject,    [4] = row->session,
                                  [6] = row->pose,      [7] = row->expression, [8] = row->note};
    for (int i = 0; i < COLUMNS; i++) {
        if (words[i]) {
            if (!is_word(field[i])) {
                return i;
            }
            (void)snprintf(words[i], SIM_CORPUS_NAME_MAX, "%s", field[i]);
        }
    }
    if (iso_text_count(field[1], &row->first)) {
        return 1;
    }
    if (iso_text_count(field[2], &row->count)) {
        return 2;
    }
    row->role = role_of(field[5]);
    return unsound_column(row);
}

/* ---- comparison of rows ------------------------------------------------ */

/* A row and its line number, for faults. */
struct line {
    const struct sim_corpus_row *row;
    unsigned number;
};

static int compare_ranges(const void *a, const void *b)
{
    const struct sim_corpus_row *p = ((const struct line *)a)->row;
    const struct sim_corpus_row *q = ((const struct line *)b)->row;
    int order = strcmp(p->recording, q->recording);
    order = order ? order : (p->first > q->first) - (p->first < q->first);
    order = order ? order : (p->count > q->count) - (p->count < q->count);
    return order ? order : (int)p->role - (int)q->role;
}

static int compare_subjects(const void *a, const void *b)
{
    const struct sim_corpus_row *p = ((const struct line *)a)->row;
    const struct sim_corpus_row *q = ((const struct line *)b)->row;
    const int order = strcmp(p->subject, q->subject);
    return order ? order : (int)p->role - (int)q->role;
}

static unsigned order_of_rows(const struct line *a, const struct line *b)
{
    return a->number > b->number ? a->number : b->number;
}

/* Checks that no row is repeated and no impostor is enrolled. Sorts `lines`. */
static int check_rows(const char *name, struct line *lines, size_t n, struct iso_fault *fault)
{
    qsort(lines, n, sizeof *lines, compare_ranges);
    for (size_t i = 1; i < n; i++) {
        if (compare_ranges(&lines[i - 1], &lines[i]) == 0) {
            return iso_fault_set(fault, -EBADMSG, "%s:%u: repeated row", name,
                                 order_of_rows(&lines[i - 1], &lines[i]));
        }
    }
    qsort(lines, n, sizeof *lines, compare_subjects);
    for (size_t i = 1, first = 0; i < n; i++) {
        if (strcmp(lines[i].row->subject, lines[first].row->subject) != 0) {
            first = i;
        } else if (lines[first].row->role == SIM_ROLE_GALLERY &&
                   lines[i].row->role == SIM_ROLE_IMPOSTOR) {
            return iso_fault_set(fault, -EBADMSG, "%s:%u: impostor '%s' is in the gallery", name,
                                 lines[i].number, lines[i].row->subject);
        }
    }
    return 0;
}

/* ---- parsing ---------------------------------------------------------------- */

static int parse_rows(const char *name, char *text, struct sim_corpus *corpus, struct line *lines,
                      struct iso_fault *fault)
{
    struct iso_text_lines walk = iso_text_lines_of(text);
    char *field[COLUMNS], *line = iso_text_next_line(&walk);
    if (!line || strcmp(line, header) != 0) {
        return iso_fault_set(fault, -EBADMSG, "%s:1: header is not `%s`", name, header);
    }
    while ((line = iso_text_next_line(&walk))) {
        struct sim_corpus_row *row = &corpus->rows[corpus->n_rows];
        const size_t fields = iso_text_split(line, ',', field, COLUMNS);
        if (fields != COLUMNS) {
            return iso_fault_set(fault, -EBADMSG, "%s:%u: %zu fields instead of %d", name,
                                 walk.number, fields, COLUMNS);
        }
        const int column = fill_row(field, row);
        if (column >= 0) {
            return iso_fault_set(fault, -EBADMSG, "%s:%u: bad %s '%s'", name, walk.number,
                                 column_names[column], field[column]);
        }
        lines[corpus->n_rows++] = (struct line){row, walk.number};
    }
    if (corpus->n_rows == 0) {
        return iso_fault_set(fault, -EBADMSG, "%s: no rows", name);
    }
    return 0;
}

static struct sim_corpus *new_corpus(size_t capacity)
{
    struct sim_corpus *corpus = calloc(1, sizeof *corpus);
    if (corpus && !(corpus->rows = calloc(capacity, sizeof *corpus->rows))) {
        free(corpus);
        return NULL;
    }
    return corpus;
}

int sim_corpus_parse(const char *name, const char *text, struct sim_corpus **out,
                     struct iso_fault *fault)
{
    const size_t capacity = iso_text_line_count(text);
    char *copy = strdup(text);
    struct line *lines = calloc(capacity, sizeof *lines);
    struct sim_corpus *corpus = new_corpus(capacity);
    int error = 0;
    if (!copy || !lines || !corpus) {
        error = iso_fault_set(fault, -ENOMEM, "%s: out of memory", name);
    }
    if (!error) {
        error = parse_rows(name, copy, corpus, lines, fault);
    }
    if (!error) {
        error = check_rows(name, lines, corpus->n_rows, fault);
    }
    if (!error) {
        *out = corpus;
        corpus = NULL;
    }
    sim_corpus_free(corpus);
    free(lines);
    free(copy);
    return error;
}

size_t sim_corpus_origin_length(const char *note)
{
    return strcspn(note, " ");
}

bool sim_corpus_row_is_of(const struct sim_corpus_row *row, const char *note)
{
    const size_t length = sim_corpus_origin_length(note);
    return length > 0 && length == sim_corpus_origin_length(row->note) &&
           memcmp(row->note, note, length) == 0;
}

void sim_corpus_free(struct sim_corpus *corpus)
{
    if (corpus) {
        free(corpus->rows);
        free(corpus);
    }
}

/* ---- files ------------------------------------------------------------------ */

static int count_frames(const char *directory, const char *recording, size_t *frames,
                        struct iso_fault *fault)
{
    char path[PATH_MAX];
    struct iso_recording *opened;
    int error = iso_path_join(directory, recording, path, fault);
    if (!error) {
        error = iso_recording_open(path, &opened, fault);
    }
    if (!error) {
        *frames = iso_recording_frames(opened);
        iso_recording_close(opened);
    }
    return error;
}

/* Checks that the frames of every row exist. A parsed manifest has no blank lines, so that row i is
 * on line i + 2. */
static int check_ranges(const char *directory, const char *manifest,
                        const struct sim_corpus *corpus, struct iso_fault *fault)
{
    const char *counted = NULL; /* rows of one recording mostly follow each other */
    size_t frames = 0;
    for (size_t i = 0; i < corpus->n_rows; i++) {
        const struct sim_corpus_row *row = &corpus->rows[i];
        struct iso_fault reason = {.text = ""};
        if (!counted || strcmp(counted, row->recording) != 0) {
            const int error = count_frames(directory, row->recording, &frames, &reason);
            if (error) {
                return iso_fault_set(fault, error == -ENOMEM ? error : -EBADMSG, "%s:%zu: %s",
                                     manifest, i + 2, reason.text);
            }
            counted = row->recording;
        }
        if (row->first >= frames || row->count > frames - row->first) {
            return iso_fault_set(fault, -EBADMSG, "%s:%zu: recording %s has %zu frames", manifest,
                                 i + 2, row->recording, frames);
        }
    }
    return 0;
}

int sim_corpus_read(const char *directory, struct sim_corpus **out, struct iso_fault *fault)
{
    char path[PATH_MAX], *text = NULL;
    struct sim_corpus *corpus = NULL;
    int error = iso_path_join(directory, "manifest.csv", path, fault);
    if (!error) {
        error = iso_text_read(path, MANIFEST_BYTES_MAX, &text, fault);
    }
    if (!error) {
        error = sim_corpus_parse(path, text, &corpus, fault);
    }
    if (!error) {
        error = check_ranges(directory, path, corpus, fault);
    }
    if (!error) {
        *out = corpus;
        corpus = NULL;
    }
    sim_corpus_free(corpus);
    free(text);
    return error;
}

/* Checks that sim_corpus_parse would accept the rows. */
static int check_writable(const char *path, const struct sim_corpus_row *rows, size_t n_rows,
                          struct iso_fault *fault)
{
    struct line *lines = calloc(n_rows + 1, sizeof *lines);
    int error = 0;
    if (!lines) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    for (size_t i = 0; i < n_rows && !error; i++) {
        lines[i] = (struct line){&rows[i], (unsigned)i + 2};
        const int column = unsound_column(&rows[i]);
        if (column >= 0) {
            error = iso_fault_set(fault, -EINVAL, "%s:%zu: bad %s", path, i + 2,
                                  column_names[column]);
        }
    }
    if (!error && n_rows == 0) {
        error = iso_fault_set(fault, -EINVAL, "%s: no rows", path);
    }
    if (!error && check_rows(path, lines, n_rows, fault)) {
        error = -EINVAL;
    }
    free(lines);
    return error;
}

static int write_rows(const char *path, const struct sim_corpus_row *rows, size_t n_rows,
                      struct iso_fault *fault)
{
    FILE *file = fopen(path, "we");
    if (!file) {
        return iso_fault_set(fault, -errno, "%s: %m", path);
    }
    bool written = fprintf(file, "%s\n", header) > 0;
    for (size_t i = 0; i < n_rows && written; i++) {
        const struct sim_corpus_row *row = &rows[i];
        written = fprintf(file, "%s,%zu,%zu,%s,%s,%s,%s,%s,%s\n", row->recording, row->first,
                          row->count, row->subject, row->session, sim_role_name(row->role),
                          row->pose, row->expression, row->note) > 0;
    }
    int error = written ? 0 : -errno;
    if (fclose(file) != 0 && !error) {
        error = -errno;
    }
    return error ? iso_fault_set(fault, error, "%s: %s", path, strerror(-error)) : 0;
}

int sim_corpus_write(const char *directory, const struct sim_corpus_row *rows, size_t n_rows,
                     struct iso_fault *fault)
{
    char path[PATH_MAX], fresh[PATH_MAX];
    int error = iso_path_join(directory, "manifest.csv", path, fault);
    if (!error) {
        error = iso_path_join(directory, "manifest.csv.new", fresh, fault);
    }
    if (!error) {
        error = check_writable(path, rows, n_rows, fault);
    }
    if (error) {
        return error;
    }
    error = write_rows(fresh, rows, n_rows, fault);
    if (!error && rename(fresh, path) != 0) {
        error = iso_fault_set(fault, -errno, "%s: %m", path);
    }
    if (error) {
        (void)unlink(fresh);
    }
    return error;
}
