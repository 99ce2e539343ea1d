/* Renders a scan by a virtual depth camera, so that it can be recorded like any other frame. */
#ifndef SIM_CORPUS_SCAN_VIEW_H
#define SIM_CORPUS_SCAN_VIEW_H

#include "drivers/file/png.h"
#include "isotherm/frame.h"
#include "isotherm/mesh.h"

/* The camera looks along -z of the scan's frame at the middle of its points. The nearest point
 * (except for 1 % of the points) is 600 mm away. 640 x 480 pixels of 0.67 mm at that distance. */
extern const struct iso_camera sim_scan_camera;

/* Draws into a new frame, without noise. -ENOMEM. The mesh is moved into the camera's frame. */
int sim_scan_view(struct iso_mesh *scan, struct iso_frame **out)
    __attribute__((warn_unused_result));

/* A range image of the Texas 3DFRD (Gupta, Castleman, Markey and Bovik 2010): 8-bit grey,
 * orthographic, 0.32 mm for each pixel and level_mm for each grey level; brighter is nearer and
 * 0 is not measured. The portrait (NULL: none) is 8-bit grey or RGB of the same size and becomes
 * the intensity. Level 255 is placed at 600 mm. -EINVAL for pictures of other kinds or sizes or if
 * level_mm is not positive, -ENOMEM. */
int sim_scan_of_range(const struct iso_image *range, const struct iso_image *portrait,
                      double level_mm, struct iso_frame **out) __attribute__((warn_unused_result));

#endif
