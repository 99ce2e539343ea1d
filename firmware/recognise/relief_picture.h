/* A depth frame as a picture that a person can judge: is the camera upright, is somebody in view,
 * what is not measured. */
#ifndef ISO_FIRMWARE_RECOGNISE_RELIEF_PICTURE_H
#define ISO_FIRMWARE_RECOGNISE_RELIEF_PICTURE_H

#include "core/base/fault.h"
#include "drivers/file/png.h"
#include "isotherm/frame.h"

enum { ISO_RELIEF_WIDTH_PX = 320, ISO_RELIEF_HEIGHT_PX = 240 };

/* Draws the frame as ISO_PIXEL_GREY8, shrunk by a whole factor until it is not larger than the
 * sizes above. Surfaces are lit from the upper left; what is farther away is darker; what is not
 * measured is black, and nothing else is. The caller frees *out with iso_image_done(). It shows the
 * shape of a face: wipe it. -ENOMEM, -EINVAL a frame that is too large to be shrunk. */
int iso_relief_picture(const struct iso_frame *frame, struct iso_image *out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* The same as a PNG in a sealed memory file: nobody can change it any more. Returns a descriptor
 * that the caller closes, or a negative errno. It waits for nobody. */
int iso_relief_picture_file(const struct iso_frame *frame, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
