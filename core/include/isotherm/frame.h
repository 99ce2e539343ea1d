/** @file
 * One depth frame: a plane of depths, the camera that saw it, and when.
 *
 * The plane is a window of the camera's image: frame pixel (column, row) is camera pixel
 * (column + crop_x_px, row + crop_y_px). Depth is measured along the optical axis in millimetres.
 * 0 means "not measured", and nothing else does: iso_frame_check() refuses NaN, infinite and
 * negative depths, so that every later step may test `> 0` alone. */
#ifndef ISOTHERM_FRAME_H
#define ISOTHERM_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "isotherm/camera.h"
#include "isotherm/fault.h"

/** A depth frame. iso_frame_new() makes one whose planes belong to it. A caller may also fill in
 * the struct itself, with planes of its own, and does not call iso_frame_free() then. */
struct iso_frame {
    struct iso_camera camera; /**< The camera that saw the frame. */
    int width_px;             /**< Width of the planes, pixels. */
    int height_px;            /**< Height of the planes, pixels. */
    int crop_x_px;            /**< Column of the window's corner in the camera's image. */
    int crop_y_px;            /**< Row of the window's corner in the camera's image. */
    int64_t t_ns;             /**< Monotonic time of exposure, nanoseconds. */
    uint64_t sequence;        /**< Counts the sensor's frames; a gap is a lost frame. */
    float *depth_mm;          /**< [height_px * width_px], row by row, millimetres. */
    float *intensity;         /**< The same shape, registered, 0..1; NULL if there is none. */
};

/** Makes a frame with planes of zeros. The crop is 0, and so are time and sequence.
 *
 * @param camera          The camera; it is copied.
 * @param width_px        Width of the planes, 1..8192 pixels.
 * @param height_px       Height of the planes, 1..8192 pixels.
 * @param with_intensity  Whether the frame has a plane of intensities.
 * @param out             Receives the frame; free it with iso_frame_free().
 * @return 0; -EINVAL for a size out of range; -ENOMEM. */
int iso_frame_new(const struct iso_camera *camera, int width_px, int height_px, bool with_intensity,
                  struct iso_frame **out) __attribute__((warn_unused_result));

/** Frees a frame that iso_frame_new() made, with its planes.
 *
 * @param frame  The frame, or NULL. */
void iso_frame_free(struct iso_frame *frame);

/** Checks that a frame can be worked on: camera, size and crop are sane, and every depth is finite
 * and at least 0.
 *
 * @param frame  The frame.
 * @param fault  If not NULL: on failure, receives a text that says what is wrong.
 * @return 0, or -EINVAL. */
int iso_frame_check(const struct iso_frame *frame, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/** The depth of a pixel.
 *
 * @param frame   The frame.
 * @param column  Column in the frame, 0..width_px - 1.
 * @param row     Row in the frame, 0..height_px - 1.
 * @return Millimetres along the optical axis; 0 if nothing was measured. */
static inline float iso_frame_depth_at(const struct iso_frame *frame, int column, int row)
{
    return frame->depth_mm[(size_t)row * (size_t)frame->width_px + (size_t)column];
}

/** The point of space that a pixel saw.
 *
 * @param frame   The frame.
 * @param column  Column in the frame, 0..width_px - 1.
 * @param row     Row in the frame, 0..height_px - 1.
 * @return The point in the camera frame, millimetres; valid only where the depth is above 0. */
struct iso_vec3 iso_frame_point_at(const struct iso_frame *frame, int column, int row);

#endif
