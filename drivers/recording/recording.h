/* Recordings: directories with the frames of one depth sensor, format 1.
 *
 *   recording.ini   [recording] format = 1, sensor = NAME
 *                   [depth] projection = pinhole | orthographic; width_px, height_px;
 *                   fx_px, fy_px, k1..k3, p1, p2 (pinhole; k and p default to 0) or
 *                   pitch_mm (orthographic); cx_px, cy_px; unit_mm = millimetres per count;
 *                   nominal = yes | no (pinhole; default no): the intrinsics are those that the
 *                   manufacturer states for the model; this camera was not measured
 *   depth.txt       one line per frame, in order of time: timestamp_s filename; '#' comments
 *   depth/NAME.png   16-bit grey, counts of unit_mm along the optical axis, 0 = not measured
 *   ir.txt, ir/     optional: 8- or 16-bit grey, registered to depth pixel by pixel
 *   rgb.txt, rgb/   optional: 8-bit RGB, the same
 *   landmarks.csv   optional ground truth: frame,name,x_mm,y_mm,z_mm in the camera frame
 *
 * The cx_px and cy_px of a recording include the crop of the sensor image, so frames from a reader
 * have no crop offset. The reader refuses everything that it does not know. On a failure *fault
 * (which may be NULL) holds one line, "file: what is wrong". */
#ifndef ISO_DRIVERS_RECORDING_RECORDING_H
#define ISO_DRIVERS_RECORDING_RECORDING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "isotherm/frame.h"

enum { ISO_RECORDING_SENSOR_MAX = 32, ISO_RECORDING_LANDMARK_MAX = 32 };

/* The contents of recording.ini. The camera is that of the recorded planes and has their size. */
struct iso_recording_meta {
    char sensor[ISO_RECORDING_SENSOR_MAX]; /* letters, digits, '-', '_', '.' */
    struct iso_camera camera;
    double unit_mm; /* 0.001..100 */
    bool nominal;   /* the intrinsics are the model's, not measured on this camera */
};

/* Whether a recording can have this description: sensor name, camera (iso_camera_check) and unit.
 * 0, or -EINVAL with a fault. */
int iso_recording_meta_check(const struct iso_recording_meta *meta, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Parses the text of a recording.ini; `name` stands for the file in faults. -EBADMSG for an
 * unknown, repeated or missing section or key, a bad value, another format, a bad camera. */
int iso_recording_meta_parse(const char *name, const char *text, struct iso_recording_meta *out,
                             struct iso_fault *fault) __attribute__((warn_unused_result));

struct iso_recording;

/* Opens a recording: reads recording.ini and the lists of frames, no frame yet. If there is an
 * ir.txt, else an rgb.txt, its frames become the intensity; it must then have a line within 1 ms of
 * each line of depth.txt. -ENOENT if the directory or one of its two required files is missing,
 * -EBADMSG if the contents are refused, -ENOMEM, or the errno of open and read. One recording is
 * used by one thread at a time. */
int iso_recording_open(const char *directory, struct iso_recording **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Closes it and frees it. NULL is accepted. */
void iso_recording_close(struct iso_recording *recording);

/* The contents of recording.ini, which belong to the recording; the number of frames; and whether
 * the frames have an intensity. */
const struct iso_recording_meta *iso_recording_meta(const struct iso_recording *recording);
size_t iso_recording_frames(const struct iso_recording *recording); /* >= 1 */
bool iso_recording_has_intensity(const struct iso_recording *recording);

/* Time stamp of a frame, index < iso_recording_frames; strictly rising with the index. */
int64_t iso_recording_t_ns(const struct iso_recording *recording, size_t index);

/* A frame of the recording's shape, to be read into again and again. -ENOMEM. */
int iso_recording_frame_new(const struct iso_recording *recording, struct iso_frame **out)
    __attribute__((warn_unused_result));

/* Reads one frame; its t_ns is the recording's time stamp, its sequence the index. Intensity is
 * 0..1 (the file's full scale; RGB by Rec. 709 luma weights). A failure concerns only this frame:
 * its planes are then undefined, and the caller may continue with the next one. -ENOENT the file is
 * missing, -EBADMSG it is truncated, damaged or not of the declared size and kind, -EINVAL the
 * index or the frame's shape is wrong, -ENOMEM, or the errno of open and read. */
int iso_recording_read(struct iso_recording *recording, size_t index, struct iso_frame *frame,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* One row of landmarks.csv. */
struct iso_recording_landmark {
    size_t frame; /* index */
    char name[ISO_RECORDING_LANDMARK_MAX];
    struct iso_vec3 point_mm; /* camera frame */
};

/* Reads the ground truth into an array that the caller frees with free(). The rows are in the order
 * of their frames. -ENOENT if the recording has none, -EBADMSG for a row that is malformed,
 * repeated, out of order or of a frame that does not exist, -ENOMEM, or the errno of open and
 * read. */
int iso_recording_landmarks(const struct iso_recording *recording,
                            struct iso_recording_landmark **rows, size_t *n_rows,
                            struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
