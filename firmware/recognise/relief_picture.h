/* A depth frame as a picture for people. It shows whether the camera is upright, whether somebody
 * is in view, and what is not measured. */
#ifndef ISO_FIRMWARE_RECOGNISE_RELIEF_PICTURE_H
#define ISO_FIRMWARE_RECOGNISE_RELIEF_PICTURE_H

#include "core/base/fault.h"
#include "drivers/file/png.h"
#include "isotherm/frame.h"

enum { ISO_RELIEF_WIDTH_PX = 320, ISO_RELIEF_HEIGHT_PX = 240 };

/* Draws the frame as ISO_PIXEL_GREY8, reduced by a whole factor until it is not larger than the
 * sizes above. Surfaces are lit from the upper left. Farther surfaces are darker. Only pixels that
 * are not measured are black. The caller frees *out with iso_image_done(). The picture shows the
 * shape of a face, so the caller has to wipe it. -ENOMEM, -EINVAL a frame that is too large to be
 * reduced. */
int iso_relief_picture(const struct iso_frame *frame, struct iso_image *out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* The same as a PNG in a sealed memory file, which nobody can change any more. Returns a descriptor
 * that the caller closes, or a negative errno. Does not block. */
int iso_relief_picture_file(const struct iso_frame *frame, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
