/* Draws the surface of a depth frame as it is seen from the front of the face, without a mesh. The
 * planes become those that iso_triangulate() and iso_raster_triangles() would make, to the bit (but
 * for the last bits where the compiler fuses multiplications with additions).
 *
 * The pixels of the new view are mostly further apart than those of the frame, so that most cells
 * of the frame (cell.h) cover the centre of no pixel. Where the corners of the cells appear is
 * computed in single precision for whole rows; only cells whose corners enclose a centre, or nearly
 * do, are divided into triangles and drawn, in double precision. */
#ifndef ISO_CORE_SURFACE_RESAMPLE_H
#define ISO_CORE_SURFACE_RESAMPLE_H

#include "core/surface/raster.h"
#include "isotherm/frame.h"

/* Draws the triangles of a frame that face the view into the planes of the view, which are not
 * cleared. The view is orthographic, in the frame of the patch (face_patch.h). Triangles that span
 * more than jump_mm of the frame's depth are left out, and so are those nearer to the view than
 * 1 mm. All get the index 0. */
void iso_resample(const struct iso_frame *frame, double jump_mm,
                  const struct iso_rigid *face_from_camera, const struct iso_raster *view);

#endif
