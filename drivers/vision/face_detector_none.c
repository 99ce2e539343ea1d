/* The detector in a build without OpenCV: there is none. */
#include "drivers/vision/face_detector.h"

#include <errno.h>

const char *iso_face_detector_engine(void)
{
    return "";
}

const char *iso_face_detector_cascade(void)
{
    return "";
}

int iso_face_detector_new(const char *cascade_path, struct iso_face_detector **out,
                          struct iso_fault *fault)
{
    (void)out;
    return iso_fault_set(fault, -ENOSYS, "%s: this build has no OpenCV to use it", cascade_path);
}

void iso_face_detector_free(struct iso_face_detector *detector)
{
    (void)detector;
}

int iso_face_detector_find(struct iso_face_detector *detector, const uint8_t *picture, int width_px,
                           int height_px, int min_px, int max_px, struct iso_face_box *out)
{
    (void)detector;
    (void)picture;
    (void)width_px;
    (void)height_px;
    (void)min_px;
    (void)max_px;
    (void)out;
    return -ENOSYS;
}
