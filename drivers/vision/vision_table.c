/* The table that the module `vision` exports. */
#include "drivers/vision/vision_module.h"

extern const struct iso_vision_module iso_module;

ISO_MODULE_EXPORT const struct iso_vision_module iso_module = {
    .module = ISO_MODULE(ISO_VISION_MODULE_NAME, struct iso_vision_module),
    .engine = iso_face_detector_engine,
    .cascade = iso_face_detector_cascade,
    .create = iso_face_detector_new,
    .release = iso_face_detector_free,
    .find = iso_face_detector_find,
};
