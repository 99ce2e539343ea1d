/* A detector of frontal faces in small grey pictures. Only its .cc file uses OpenCV.
 *
 * It is a boosted cascade of Haar-like features (Viola and Jones, "Rapid object detection using a
 * boosted cascade of simple features", CVPR 2001; Lienhart and Maydt, ICIP 2002), as stored in
 * OpenCV's files. Its code is the module `vision` (drivers/base/module.h). Without the module the
 * engine is
 * "" and no detector can be made. A detector is used by one thread at a time and starts no threads.
 * OpenCV allocates while it searches. */
#ifndef ISO_DRIVERS_VISION_FACE_DETECTOR_H
#define ISO_DRIVERS_VISION_FACE_DETECTOR_H

#include <stdint.h>

#include "core/base/fault.h"

/* The square in which a face is seen. */
struct iso_face_box {
    double column_px, row_px, side_px; /* its middle; whole numbers are the centres of pixels */
    int votes; /* windows that agreed on it; 0: no face is seen, and all else is 0 */
};

struct iso_face_detector;

/* Loads the module, unless it is loaded. The errors of iso_module_load. */
int iso_face_detector_load(struct iso_fault *fault) __attribute__((warn_unused_result));

/* "OpenCV 4.6.0", or "" without the module. */
const char *iso_face_detector_engine(void);

/* The cascade that the module was built with; "" if there was none. */
const char *iso_face_detector_cascade(void);

/* Reads a cascade. The errors of iso_face_detector_load, -EBADMSG the file is no cascade, -ENOMEM,
 * or the errno of opening it. */
int iso_face_detector_new(const char *cascade_path, struct iso_face_detector **out,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

/* Frees it. NULL is accepted. */
void iso_face_detector_free(struct iso_face_detector *detector);

/* Looks for a face whose square has a side of min_px..max_px in a picture, rows from the top
 * without padding; *out is the one with the most votes. -EINVAL sizes out of range (1..8192, min <=
 * max), -ENOMEM, -EIO anything else that OpenCV refuses. */
int iso_face_detector_find(struct iso_face_detector *detector, const uint8_t *picture, int width_px,
                           int height_px, int min_px, int max_px, struct iso_face_box *out)
    __attribute__((warn_unused_result));

#endif
