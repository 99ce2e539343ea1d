#include <errno.h>

#include "core/base/text.h"
#include "core/shape/mesh/mesh_build.h"

/* Reads three words of the next line that is not blank; *n is 0 at the end. */
static int next_three(struct iso__mesh_build *build, struct iso_text_lines *lines, char *words[3],
                      size_t *n)
{
    *n = 0;
    for (char *line; *n == 0 && (line = iso_text_next_line(lines));) {
        *n = iso_text_words(line, words, 3);
    }
    return *n == 0 || *n == 3
               ? 0
               : iso_fault_set(build->fault, -EBADMSG, "%s:%u: %zu numbers instead of 3",
                               build->name, lines->number, *n);
}

static int read_triangle(struct iso__mesh_build *build, unsigned line, char *const words[3])
{
    int32_t corner[3];
    for (int k = 0; k < 3; k++) {
        size_t index = 0;
        if (iso_text_count(words[k], &index) || index < 1 || index > (size_t)ISO__MESH_MOST) {
            return iso__mesh_build_refuse(build, line, "bad corner (they count from 1)", words[k]);
        }
        corner[k] = (int32_t)index - 1;
    }
    return iso__mesh_build_triangle(build, line, corner);
}

int iso__mesh_read_tosca(struct iso__mesh_build *build, char *vert, char *tri)
{
    struct iso_text_lines lines = iso_text_lines_of(vert);
    char *words[3];
    size_t n = 0;
    int error = 0;
    while (!(error = next_three(build, &lines, words, &n)) && n > 0) {
        struct iso_vec3 at_mm;
        error = iso__mesh_build_place(build, lines.number, words, &at_mm);
        if (!error) {
            error = iso__mesh_build_vertex(build, lines.number, at_mm, NULL);
        }
        if (error) {
            return error;
        }
    }
    lines = iso_text_lines_of(tri);
    while (!error && !(error = next_three(build, &lines, words, &n)) && n > 0) {
        error = read_triangle(build, lines.number, words);
    }
    return error;
}
