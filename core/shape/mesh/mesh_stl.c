#include <errno.h>
#include <math.h>
#include <string.h>

#include "core/base/bytes.h"
#include "core/base/text.h"
#include "core/shape/mesh/mesh_build.h"

/* 80 arbitrary bytes, a count, then triangles: a normal, three corners and two spare bytes. */
enum { HEADER_BYTES = 80, FIRST_BYTE = HEADER_BYTES + 4, TRIANGLE_BYTES = 50 };

static int add_corner(struct iso__mesh_build *build, unsigned line, struct iso_vec3 at_mm)
{
    int error = iso__mesh_build_vertex(build, line, at_mm, NULL);
    const int32_t n = build->made.mesh->n_vertices;
    if (!error && n % 3 == 0) {
        error = iso__mesh_build_triangle(build, line, (int32_t[3]){n - 3, n - 2, n - 1});
    }
    return error;
}

static int read_binary(struct iso__mesh_build *build, const uint8_t *bytes, uint32_t n_triangles)
{
    for (uint32_t t = 0; t < n_triangles; t++) {
        const uint8_t *corner = bytes + FIRST_BYTE + (size_t)t * TRIANGLE_BYTES + 12;
        for (int k = 0; k < 3; k++, corner += 12) {
            struct iso_vec3 p = iso_vec3((double)iso_get_f32(corner),
                                         (double)iso_get_f32(corner + 4),
                                         (double)iso_get_f32(corner + 8));
            if (!isfinite(p.x) || !isfinite(p.y) || !isfinite(p.z)) {
                return iso_fault_set(build->fault, -EBADMSG,
                                     "%s: triangle %u has a corner that is not finite", build->name,
                                     (unsigned)t + 1);
            }
            const int error = add_corner(build, t + 1, p);
            if (error) {
                return error;
            }
        }
    }
    return 0;
}

static int read_text(struct iso__mesh_build *build, char *text)
{
    static const char *const words_of_form[] = {"solid",   "facet",    "outer",
                                                "endloop", "endfacet", "endsolid"};
    struct iso_text_lines lines = iso_text_lines_of(text);
    for (char *line, *words[5]; (line = iso_text_next_line(&lines));) {
        size_t n = iso_text_words(line, words, 5), form = 0;
        if (n == 0) {
            continue;
        }
        if (strcmp(words[0], "vertex") == 0 && n == 4) {
            struct iso_vec3 at_mm;
            int error = iso__mesh_build_place(build, lines.number, words + 1, &at_mm);
            if (!error) {
                error = add_corner(build, lines.number, at_mm);
            }
            if (error) {
                return error;
            }
            continue;
        }
        while (form < sizeof words_of_form / sizeof *words_of_form &&
               strcmp(words[0], words_of_form[form]) != 0) {
            form++;
        }
        if (form == sizeof words_of_form / sizeof *words_of_form) {
            return iso__mesh_build_refuse(build, lines.number,
                                          "not a line of an STL file:", words[0]);
        }
        if (strcmp(words[0], "endfacet") == 0 && build->made.mesh->n_vertices % 3 != 0) {
            return iso_fault_set(build->fault, -EBADMSG, "%s:%u: a facet that is no triangle",
                                 build->name, lines.number);
        }
    }
    if (build->made.mesh->n_vertices % 3 != 0) {
        return iso_fault_set(build->fault, -EBADMSG, "%s: ends within a triangle", build->name);
    }
    return 0;
}

int iso__mesh_read_stl(struct iso__mesh_build *build, char *bytes, size_t size)
{
    const uint8_t *binary = (const uint8_t *)bytes;
    if (size >=
        FIRST_BYTE) { /* binary files may begin with "solid", too; their size identifies them */
        const uint32_t n = iso_get_u32(binary + HEADER_BYTES);
        if (size - FIRST_BYTE == (size_t)n * TRIANGLE_BYTES) {
            return read_binary(build, binary, n);
        }
    }
    if (strncmp(bytes, "solid", 5) != 0) {
        return iso_fault_set(build->fault, -EBADMSG,
                             "%s: neither text nor as long as its number of triangles requires",
                             build->name);
    }
    if (memchr(bytes, 0, size)) {
        return iso_fault_set(build->fault, -EBADMSG, "%s: text with a NUL byte", build->name);
    }
    return read_text(build, bytes);
}
