#include <errno.h>
#include <string.h>

#include "core/base/text.h"
#include "core/shape/mesh/mesh_build.h"

/* Statements that do not concern the surface. */
static const char *const passed_over[] = {"vn",     "vt",     "vp", "g", "o",      "s",
                                          "usemtl", "mtllib", "l",  "p", "usemap", "maplib"};

static int read_vertex(struct iso__mesh_build *build, unsigned line, char *rest)
{
    char *words[8];
    const size_t n = iso_text_words(rest, words, 8); /* x y z, x y z w, or x y z r g b */
    if (n != 3 && n != 4 && n != 6) {
        return iso_fault_set(build->fault, -EBADMSG, "%s:%u: %zu numbers of a vertex", build->name,
                             line, n);
    }
    struct iso_vec3 at_mm;
    struct iso_colour colour;
    int error = iso__mesh_build_place(build, line, words, &at_mm);
    if (!error && n == 6) {
        error = iso__mesh_build_colour(build, line, words + 3, &colour);
    }
    if (error) {
        return error;
    }
    return iso__mesh_build_vertex(build, line, at_mm, n == 6 ? &colour : NULL);
}

/* "7", "7/1", "7//2", "7/1/2", counted from 1; or backwards, where -1 is the last vertex. */
static int read_corner(const struct iso__mesh_build *build, unsigned line, char *word, int32_t *out)
{
    size_t index = 0;
    const int32_t n_vertices = build->made.mesh->n_vertices;
    const char *digits = word[0] == '-' ? word + 1 : word;
    char *slash = strchr(word, '/'), after = '\0';
    if (slash) {
        after = slash[1];
        *slash = '\0';
    }
    if (iso_text_count(digits, &index) || index < 1 || index > (size_t)ISO__MESH_MOST ||
        (word[0] == '-' && index > (size_t)n_vertices) ||
        (slash && !strchr("/0123456789-", after))) {
        return iso__mesh_build_refuse(build, line, "bad corner", word);
    }
    *out = word[0] == '-' ? n_vertices - (int32_t)index : (int32_t)index - 1;
    return 0;
}

static int read_face(struct iso__mesh_build *build, unsigned line, char *text)
{
    char *rest, *word = strtok_r(text, " \t", &rest);
    int32_t corner[3] = {0, 0, 0};
    int n = 0, error = 0;
    for (; word && !error; n++, word = strtok_r(NULL, " \t", &rest)) {
        error = read_corner(build, line, word, &corner[n < 2 ? n : 2]);
        if (!error && n >= 2) {
            error = iso__mesh_build_triangle(build, line, corner);
            corner[1] = corner[2];
        }
    }
    if (!error && n < 3) {
        return iso_fault_set(build->fault, -EBADMSG, "%s:%u: a face of %d corners", build->name,
                             line, n);
    }
    return error;
}

static int read_line(struct iso__mesh_build *build, unsigned number, char *line)
{
    line += strspn(line, " \t");
    char *rest = line + strcspn(line, " \t");
    if (*rest) {
        *rest++ = '\0';
    }
    if (strcmp(line, "v") == 0) {
        return read_vertex(build, number, rest);
    }
    if (strcmp(line, "f") == 0) {
        return read_face(build, number, rest);
    }
    for (size_t i = 0; i < sizeof passed_over / sizeof *passed_over; i++) {
        if (strcmp(line, passed_over[i]) == 0) {
            return 0;
        }
    }
    return *line ? iso__mesh_build_refuse(build, number, "unknown statement", line) : 0;
}

int iso__mesh_read_obj(struct iso__mesh_build *build, char *text)
{
    struct iso_text_lines lines = iso_text_lines_of(text);
    int error = 0;
    for (char *line; !error && (line = iso_text_next_line(&lines));) {
        *strchrnul(line, '#') = '\0';
        error = read_line(build, lines.number, line);
    }
    return error;
}
