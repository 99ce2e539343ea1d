/* XYZ: a point in each line. Programs write what they like after its three numbers, such as a
 * normal or a colour of unknown scale, so that the rest of a line is ignored. */
#include <errno.h>
#include <string.h>

#include "core/base/text.h"
#include "core/shape/mesh/mesh_build.h"

int iso__mesh_read_xyz(struct iso__mesh_build *build, char *text)
{
    struct iso_text_lines lines = iso_text_lines_of(text);
    int error = 0;
    for (char *line; !error && (line = iso_text_next_line(&lines));) {
        char *words[3];
        struct iso_vec3 at_mm;
        *strchrnul(line, '#') = '\0';
        const size_t n = iso_text_words(line, words, 3);
        if (n == 0) {
            continue;
        }
        if (n < 3) {
            return iso_fault_set(build->fault, -EBADMSG, "%s:%u: %zu numbers of a point",
                                 build->name, lines.number, n);
        }
        error = iso__mesh_build_place(build, lines.number, words, &at_mm);
        if (!error) {
            error = iso__mesh_build_vertex(build, lines.number, at_mm, NULL);
        }
    }
    return error;
}
