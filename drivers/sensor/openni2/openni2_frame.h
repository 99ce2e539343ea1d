/* Converts OpenNI2's frames to ours. Pure: no device is used. */
#ifndef ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_FRAME_H
#define ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_FRAME_H

#include <stdbool.h>

#include "drivers/sensor/openni2/openni2_api.h"
#include "isotherm/camera.h"
#include "isotherm/frame.h"

/* Millimetres per count of a depth format; 0 for a format without lengths. */
double iso__openni2_unit_mm(OniPixelFormat format);

/* The camera that sees width x height pixels under these angles: focal length
 * (size / 2) / tan(view / 2), principal point in the middle, which is between the pixels of an even
 * size. OpenNI2's own conversion has it half a pixel further, at pixel size / 2. */
struct iso_camera iso__openni2_camera(int width_px, int height_px, double view_x_rad,
                                      double view_y_rad);

/* Writes depths, size and crop of `in` into *out, which has planes of its camera's size. `mirrored`
 * turns it back. Pixels beyond the crop are not in the frame. 0, or -EBADMSG with a fault that
 * says what is wrong with the frame ("is truncated"), and *out as it was. */
int iso__openni2_read_depth(const OniFrame *in, bool mirrored, struct iso_frame *out,
                            struct iso_fault *fault);

/* Writes the intensity into a frame that read_depth has filled. A value of `full_scale` and every
 * larger one becomes 1; a colour becomes grey by its Rec. 709 luma. The errors of read_depth, and
 * -EBADMSG if the image does not cover the same pixels. */
int iso__openni2_read_intensity(const OniFrame *in, bool mirrored, double full_scale,
                                struct iso_frame *out, struct iso_fault *fault);

#endif
