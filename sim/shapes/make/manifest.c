#include "sim/shapes/make/manifest.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"
#include "drivers/file/text.h"
#include "sim/base/result_file.h"

enum { BYTES_MAX = 16 << 20, ROWS_MAX = 100000 };

static const char header[] = "file,class";

static bool is_word(const char *word)
{
    const size_t length = strlen(word);
    for (size_t i = 0; i < length; i++) {
        unsigned char c = (unsigned char)word[i];
        if (c < ' ' || c == 127 || c == '"') {
            return false;
        }
    }
    return length > 0 && length < SIM_SHAPE_NAME_MAX;
}

/* A file in the directory or below it. */
static bool is_file(const char *word)
{
    return is_word(word) && word[0] != '/' && word[0] != '.' && !strstr(word, "/.");
}

static int parse_rows(const char *name, char *text, struct sim_shape_manifest *manifest,
                      struct iso_fault *fault)
{
    struct iso_text_lines lines = iso_text_lines_of(text);
    char *line = iso_text_next_line(&lines), *field[2];
    if (!line || strcmp(line, header) != 0) {
        return iso_fault_set(fault, -EBADMSG, "%s:1: header is not `%s`", name, header);
    }
    while ((line = iso_text_next_line(&lines))) {
        struct sim_shape_row *row = &manifest->rows[manifest->n];
        const size_t n = iso_text_split(line, ',', field, 2);
        if (n != 2) {
            return iso_fault_set(fault, -EBADMSG, "%s:%u: %zu fields instead of 2", name,
                                 lines.number, n);
        }
        if (!is_file(field[0]) || !is_word(field[1])) {
            return iso_fault_set(fault, -EBADMSG, "%s:%u: bad %s '%.60s'", name, lines.number,
                                 is_file(field[0]) ? "class" : "file",
                                 is_file(field[0]) ? field[1] : field[0]);
        }
        (void)snprintf(row->file, sizeof row->file, "%s", field[0]);
        (void)snprintf(row->class_name, sizeof row->class_name, "%s", field[1]);
        manifest->n++;
    }
    return manifest->n > 0 ? 0 : iso_fault_set(fault, -EBADMSG, "%s: no rows", name);
}

static int compare_files(const void *a, const void *b)
{
    const struct sim_shape_row *const *p = a, *const *q = b;
    return strcmp((*p)->file, (*q)->file);
}

static int check_files(const char *name, const struct sim_shape_manifest *manifest,
                       struct iso_fault *fault)
{
    const struct sim_shape_row **order = calloc((size_t)manifest->n, sizeof *order);
    int error = 0;
    if (!order) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", name);
    }
    for (int32_t i = 0; i < manifest->n; i++) {
        order[i] = &manifest->rows[i];
    }
    qsort(order, (size_t)manifest->n, sizeof *order, compare_files);
    for (int32_t i = 1; i < manifest->n && !error; i++) {
        if (strcmp(order[i]->file, order[i - 1]->file) == 0) {
            error = iso_fault_set(fault, -EBADMSG, "%s: '%s' is listed twice", name,
                                  order[i]->file);
        }
    }
    free(order);
    return error;
}

/* The class number of row i: that of the first row with the same class, or n_so_far for a new
 * class. With `wider` it is the number of the wider class, the part before the slash. */
static int32_t number_of(const struct sim_shape_manifest *manifest, const int32_t *numbers,
                         int32_t i, bool wider, int32_t n_so_far)
{
    const char *mine = manifest->rows[i].class_name;
    const size_t length = wider ? strcspn(mine, "/") : strlen(mine);
    for (int32_t j = 0; j < i; j++) {
        const char *other = manifest->rows[j].class_name;
        const size_t other_length = wider ? strcspn(other, "/") : strlen(other);
        if (length == other_length && memcmp(mine, other, length) == 0) {
            return numbers[j];
        }
    }
    return n_so_far;
}

static void number_classes(struct sim_shape_manifest *manifest)
{
    manifest->n_classes = manifest->n_wider = 0;
    for (int32_t i = 0; i < manifest->n; i++) {
        const int32_t c = number_of(manifest, manifest->class_of, i, false, manifest->n_classes);
        const int32_t w = number_of(manifest, manifest->wider_of, i, true, manifest->n_wider);
        manifest->class_of[i] = c;
        manifest->wider_of[i] = w;
        if (c == manifest->n_classes) {
            manifest->class_name[manifest->n_classes++] = manifest->rows[i].class_name;
        }
        manifest->n_wider += w == manifest->n_wider;
    }
}

static struct sim_shape_manifest *new_manifest(size_t most)
{
    struct sim_shape_manifest *manifest = calloc(1, sizeof *manifest);
    if (!manifest) {
        return NULL;
    }
    manifest->rows = calloc(most, sizeof *manifest->rows);
    manifest->class_of = calloc(most, sizeof *manifest->class_of);
    manifest->wider_of = calloc(most, sizeof *manifest->wider_of);
    manifest->class_name = calloc(most, sizeof *manifest->class_name);
    if (!manifest->rows || !manifest->class_of || !manifest->wider_of || !manifest->class_name) {
        sim_shape_manifest_free(manifest);
        return NULL;
    }
    return manifest;
}

int sim_shape_manifest_parse(const char *name, const char *text, struct sim_shape_manifest **out,
                             struct iso_fault *fault)
{
    const size_t most = iso_text_line_count(text);
    if (most > ROWS_MAX) {
        return iso_fault_set(fault, -EBADMSG, "%s: more than %d rows", name, (int)ROWS_MAX);
    }
    char *copy = strdup(text);
    struct sim_shape_manifest *manifest = copy ? new_manifest(most) : NULL;
    int error = manifest ? 0 : iso_fault_set(fault, -ENOMEM, "%s: out of memory", name);
    if (!error) {
        error = parse_rows(name, copy, manifest, fault);
    }
    if (!error) {
        error = check_files(name, manifest, fault);
    }
    free(copy);
    if (error) {
        sim_shape_manifest_free(manifest);
        return error;
    }
    number_classes(manifest);
    *out = manifest;
    return 0;
}

int sim_shape_manifest_of(const struct sim_shape_row *rows, int32_t n,
                          struct sim_shape_manifest **out)
{
    struct sim_shape_manifest *manifest = new_manifest((size_t)n);
    if (!manifest) {
        return -ENOMEM;
    }
    memcpy(manifest->rows, rows, (size_t)n * sizeof *rows);
    manifest->n = n;
    number_classes(manifest);
    *out = manifest;
    return 0;
}

int sim_shape_manifest_turns(const struct sim_shape_manifest *manifest, size_t wanted,
                             int32_t *rows, int32_t *n)
{
    int32_t *turn = calloc((size_t)manifest->n, sizeof *turn);
    int32_t *seen = calloc((size_t)manifest->n_classes, sizeof *seen);
    const int error = turn && seen ? 0 : -ENOMEM;
    *n = 0;
    for (int32_t i = 0; !error && i < manifest->n; i++) {
        turn[i] = seen[manifest->class_of[i]]++;
    }
    for (int32_t round = 0; !error && round < manifest->n; round++) {
        for (int32_t i = 0; i < manifest->n; i++) {
            if (turn[i] == round && (wanted == 0 || (size_t)*n < wanted)) {
                rows[(*n)++] = i;
            }
        }
    }
    free(turn);
    free(seen);
    return error;
}

void sim_shape_manifest_keep(struct sim_shape_manifest *manifest, const uint8_t *keep)
{
    int32_t n = 0;
    for (int32_t i = 0; i < manifest->n; i++) {
        if (keep[i]) {
            manifest->rows[n++] = manifest->rows[i];
        }
    }
    manifest->n = n;
    number_classes(manifest);
}

void sim_shape_manifest_free(struct sim_shape_manifest *manifest)
{
    if (manifest) {
        free(manifest->rows);
        free(manifest->class_of);
        free(manifest->wider_of);
        free(manifest->class_name);
        free(manifest);
    }
}

int sim_shape_manifest_read(const char *directory, struct sim_shape_manifest **out,
                            struct iso_fault *fault)
{
    char path[PATH_MAX], *text = NULL;
    int error = iso_path_join(directory, "manifest.csv", path, fault);
    if (!error) {
        error = iso_text_read(path, BYTES_MAX, &text, fault);
        if (error == -ENOENT) {
            return sim_shape_manifest_list(directory, out, fault);
        }
    }
    if (!error) {
        error = sim_shape_manifest_parse(path, text, out, fault);
    }
    free(text);
    return error;
}

struct rows {
    const struct sim_shape_row *row;
    int32_t n;
};

static void write_rows(const void *context, FILE *out)
{
    const struct rows *rows = context;
    fprintf(out, "%s\n", header);
    for (int32_t i = 0; i < rows->n; i++) {
        fprintf(out, "%s,%s\n", rows->row[i].file, rows->row[i].class_name);
    }
}

int sim_shape_manifest_write(const char *directory, const struct sim_shape_row *rows, int32_t n,
                             struct iso_fault *fault)
{
    const struct rows all = {rows, n};
    return sim_result_file(directory, "manifest.csv", write_rows, &all, fault);
}
