#include <errno.h>
#include <stdbool.h>
#include <string.h>

#include "core/base/text.h"
#include "core/shape/mesh/mesh_build.h"

enum { WORDS_MAX = 8 };

/* Reads the next line with words, and returns their number; 0 at the end of the file. A comment
 * begins with #. */
static size_t next_words(struct iso_text_lines *lines, char **words, size_t max)
{
    size_t n = 0;
    for (char *line; n == 0 && (line = iso_text_next_line(lines));) {
        *strchrnul(line, '#') = '\0';
        n = iso_text_words(line, words, max);
    }
    return n;
}

static int ends_early(const struct iso__mesh_build *build, const char *within)
{
    return iso_fault_set(build->fault, -EBADMSG, "%s: ends within the %s", build->name, within);
}

/* "OFF" or "COFF", then, on the same line or the next, the counts. */
static int read_header(struct iso__mesh_build *build, struct iso_text_lines *lines, bool *coloured,
                       size_t *n_vertices, size_t *n_faces)
{
    char *words[WORDS_MAX], **counts = words + 1;
    size_t n = next_words(lines, words, WORDS_MAX);
    if (n == 0 || (strcmp(words[0], "OFF") != 0 && strcmp(words[0], "COFF") != 0)) {
        return iso_fault_set(build->fault, -EBADMSG, "%s:1: does not begin with OFF or COFF",
                             build->name);
    }
    *coloured = words[0][0] == 'C';
    n--;
    if (n == 0) {
        counts = words;
        n = next_words(lines, words, WORDS_MAX);
    }
    if ((n != 2 && n != 3) || iso_text_count(counts[0], n_vertices) ||
        iso_text_count(counts[1], n_faces)) {
        return iso_fault_set(build->fault, -EBADMSG, "%s:%u: bad counts", build->name,
                             lines->number);
    }
    return 0;
}

static int read_vertex(struct iso__mesh_build *build, struct iso_text_lines *lines, bool coloured)
{
    char *words[WORDS_MAX];
    const size_t n = next_words(lines, words, WORDS_MAX);
    if (n == 0) {
        return ends_early(build, "vertices");
    }
    if (coloured ? n != 6 && n != 7 : n != 3) {
        return iso_fault_set(build->fault, -EBADMSG, "%s:%u: %zu numbers of a vertex", build->name,
                             lines->number, n);
    }
    struct iso_vec3 at_mm;
    struct iso_colour colour;
    int error = iso__mesh_build_place(build, lines->number, words, &at_mm);
    if (!error && coloured) {
        error = iso__mesh_build_colour(build, lines->number, words + 3, &colour);
    }
    if (error) {
        return error;
    }
    return iso__mesh_build_vertex(build, lines->number, at_mm, coloured ? &colour : NULL);
}

/* Reads an index. Indices beyond the vertices are refused at the end. */
static int read_index(const struct iso__mesh_build *build, unsigned line, const char *word,
                      int32_t *out)
{
    size_t index;
    if (iso_text_count(word, &index) || index >= (size_t)ISO__MESH_MOST) {
        return iso__mesh_build_refuse(build, line, "bad corner", word);
    }
    *out = (int32_t)index;
    return 0;
}

/* "k i1 ... ik"; a colour may follow and is ignored. */
static int read_face(struct iso__mesh_build *build, struct iso_text_lines *lines)
{
    char *line = iso_text_next_line(lines), *rest, *word;
    while (line) {
        *strchrnul(line, '#') = '\0';
        if (line[strspn(line, " \t")]) {
            break;
        }
        line = iso_text_next_line(lines);
    }
    if (!line) {
        return ends_early(build, "faces");
    }
    const unsigned number = lines->number;
    size_t n = 0;
    word = strtok_r(line, " \t", &rest);
    if (iso_text_count(word, &n) || n < 3 || n > (size_t)ISO__MESH_CORNERS_MOST) {
        return iso__mesh_build_refuse(build, number, "bad number of corners", word);
    }
    int32_t corner[3] = {0, 0, 0};
    int error = 0;
    for (size_t i = 0; i < n && !error; i++) {
        if (!(word = strtok_r(NULL, " \t", &rest))) {
            return iso_fault_set(build->fault, -EBADMSG, "%s:%u: %zu corners instead of %zu",
                                 build->name, number, i, n);
        }
        error = read_index(build, number, word, &corner[i < 2 ? i : 2]);
        if (!error && i >= 2) {
            error = iso__mesh_build_triangle(build, number, corner);
            corner[1] = corner[2];
        }
    }
    return error;
}

int iso__mesh_read_off(struct iso__mesh_build *build, char *text)
{
    struct iso_text_lines lines = iso_text_lines_of(text);
    bool coloured = false;
    size_t n_vertices = 0, n_faces = 0;
    char *words[WORDS_MAX];
    int error = read_header(build, &lines, &coloured, &n_vertices, &n_faces);
    for (size_t i = 0; i < n_vertices && !error; i++) {
        error = read_vertex(build, &lines, coloured);
    }
    for (size_t i = 0; i < n_faces && !error; i++) {
        error = read_face(build, &lines);
    }
    if (!error && next_words(&lines, words, WORDS_MAX) > 0) {
        return iso__mesh_build_refuse(build, lines.number, "more than was announced:", words[0]);
    }
    return error;
}
