/* The upper face as a height field in the face frame: what expressions move least (Chang, Bowyer
 * and Flynn 2006), kept in a template beside the isotherms so that the few candidates of a search
 * can be compared surface to surface.
 *
 * Nodes lie ISO_UPPER_SPACING_MM apart: column ISO_UPPER_MIDDLE is at x = 0, row 0 at the top, and
 * the lowest row below the nose. A node has no surface, a surface that was filled in, or a measured
 * one. A filled-in node is needed for the slopes at its neighbours, but two surfaces are compared
 * at measured nodes only. All zero is a face without any surface. The struct has a fixed size and
 * no pointers, so that it is copied and wiped with the template. It is biometric data. */
#ifndef ISO_CORE_MATCH_UPPER_FACE_H
#define ISO_CORE_MATCH_UPPER_FACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "isotherm/template.h"
#include "isotherm/vec.h"

/* The x of a column in the face frame, mm. */
static inline double iso_upper_x_mm(int column)
{
    return (column - ISO_UPPER_MIDDLE) * ISO_UPPER_SPACING_MM;
}

/* The y of a row in the face frame, mm. */
static inline double iso_upper_y_mm(int row)
{
    return ISO_UPPER_TOP_MM - row * ISO_UPPER_SPACING_MM;
}

/* The row of a node; nodes are numbered row by row. */
static inline int iso_upper_row(int node)
{
    return node / ISO_UPPER_COLUMNS;
}

/* The column of a node. */
static inline int iso_upper_column(int node)
{
    return node % ISO_UPPER_COLUMNS;
}

/* Whether a face has any measured node. */
bool iso_upper_face_known(const struct iso_upper_face *face);

/* Whether a face can be written: all kinds are in range, heights lie within +-511 mm, and nodes
 * without a surface have the height 0. */
bool iso_upper_face_fits(const struct iso_upper_face *face);

/* Writes a face that fits. `bytes` has room for ISO_UPPER_BYTES_MAX. Returns how many bytes were
 * written. */
size_t iso_upper_face_put(const struct iso_upper_face *face, uint8_t *bytes);

/* Reads a face from `size` bytes that iso_upper_face_put wrote. -EBADMSG if the bytes have another
 * size or the face does not fit. */
int iso_upper_face_get(const uint8_t *bytes, size_t size, struct iso_upper_face *out)
    __attribute__((warn_unused_result));

enum { ISO_UPPER_FUSED_MAX = 64 };

/* The mean of n upper faces (1..ISO_UPPER_FUSED_MAX). Each is moved to the frame of the first by
 * its rigid motion; the first one is not moved. A node is the mean of the measured heights there,
 * or of the filled-in ones if no face was measured there. Faces without a measured node do not
 * count. `out` may not be one of `faces`. */
void iso_upper_face_fuse(const struct iso_upper_face *const *faces,
                         const struct iso_rigid *first_from_face, int n,
                         struct iso_upper_face *out);

#endif
