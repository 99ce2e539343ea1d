/* The module `vision` is a shared object of its own (drivers/base/module.h) with the functions of
 * face_detector.h. Programs call those functions directly; vision_module.c passes the calls to the
 * module. */
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
