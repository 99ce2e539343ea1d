/* The module `vision`: what face_detector.h declares, in a shared object of its own
 * (drivers/base/module.h). Programs call those functions as ever; vision_module.c hands the calls
 * on. */
#ifndef ISO_DRIVERS_VISION_VISION_MODULE_H
#define ISO_DRIVERS_VISION_VISION_MODULE_H

#include "drivers/base/module.h"
#include "drivers/vision/face_detector.h"

#define ISO_VISION_MODULE_NAME "vision"

struct iso_vision_module {
    struct iso_module module;
    __typeof__(iso_face_detector_engine) *engine;
    __typeof__(iso_face_detector_cascade) *cascade;
    __typeof__(iso_face_detector_new) *create;
    __typeof__(iso_face_detector_free) *release;
    __typeof__(iso_face_detector_find) *find;
};

#endif
