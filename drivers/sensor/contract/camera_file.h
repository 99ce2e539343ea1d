/* Camera files: the intrinsics of one depth camera, in the format of a recording.ini (recording.h).
 * Several back ends read their intrinsics from such a file, which the option `camera` names. */
#ifndef ISO_DRIVERS_SENSOR_CONTRACT_CAMERA_FILE_H
#define ISO_DRIVERS_SENSOR_CONTRACT_CAMERA_FILE_H

#include "core/base/fault.h"
#include "drivers/recording/recording.h"

struct iso_camera_file {
    struct iso_recording_meta meta;
    char name[48]; /* the path of the file, or the end of the path */
};

/* Reads a camera file. -ENOENT there is none, -EINVAL it cannot be read or is damaged, -ENOMEM;
 * each with a fault that names the file. */
int iso_camera_file_read(const char *path, struct iso_camera_file *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The calibration of the sensor as a text for people: "FILE", or "nominal (FILE)" if the file says
 * that its intrinsics are those of the model and were not measured. */
void iso_camera_file_describe(const struct iso_camera_file *file, char *text, size_t size);

#endif
