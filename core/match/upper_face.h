/* The upper face as a height field in the face frame: what expressions move least (Chang, Bowyer
 * and Flynn 2006), kept in a template beside the isotherms so that the few candidates of a search
 * can be compared surface to surface.
 *
 * Nodes lie ISO_UPPER_SPACING_MM apart, column ISO_UPPER_MIDDLE at x = 0, row 0 at the top, the
 * lowest row below the nose. A node has no surface, one that was filled in (it carries the slope of
 * its neighbours, but nothing is compared with it), or a measured one. All zero is a face without
 * any. Fixed size, no pointers: copied and wiped with the template. Biometric. */
#ifndef ISO_CORE_MATCH_UPPER_FACE_H
#define ISO_CORE_MATCH_UPPER_FACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "isotherm/template.h"
#include "isotherm/vec.h"

static inline double iso_upper_x_mm(int column)
{
    return (column - ISO_UPPER_MIDDLE) * ISO_UPPER_SPACING_MM;
}
static inline double iso_upper_y_mm(int row)
{
    return ISO_UPPER_TOP_MM - row * ISO_UPPER_SPACING_MM;
}

/* Where a node lies of those counted row by row. */
static inline int iso_upper_row(int node)
{
    return node / ISO_UPPER_COLUMNS;
}
static inline int iso_upper_column(int node)
{
    return node % ISO_UPPER_COLUMNS;
}

/* Whether a face has any measured node. */
bool iso_upper_face_known(const struct iso_upper_face *face);

/* Whether it can be written: kinds in range, heights within +-511 mm, 0 where there is none. */
bool iso_upper_face_fits(const struct iso_upper_face *face);

/* Writes a face that fits; room for ISO_UPPER_BYTES_MAX. Returns the bytes written. */
size_t iso_upper_face_put(const struct iso_upper_face *face, uint8_t *bytes);

/* Reads what iso_upper_face_put wrote, which is all of the `size` bytes. -EBADMSG if it is not. */
int iso_upper_face_get(const uint8_t *bytes, size_t size, struct iso_upper_face *out)
    __attribute__((warn_unused_result));

enum { ISO_UPPER_FUSED_MAX = 64 };

/* The mean of n height fields (1..ISO_UPPER_FUSED_MAX), each brought to the frame of the first by a
 * rigid motion: of what was measured; where none was, of what was filled in. Fields without a
 * measured node do not count. `out` may not be one of them. */
void iso_upper_face_fuse(const struct iso_upper_face *const *faces,
                         const struct iso_rigid *first_from_face, int n,
                         struct iso_upper_face *out);

#endif
