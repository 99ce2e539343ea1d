/* The module `libcamera` is a shared object of its own (drivers/base/module.h) with the functions
 * of libcamera_pair.h. Programs call those functions directly; libcamera_module.c passes the calls
 * to the module. */
#ifndef ISO_DRIVERS_SENSOR_LIBCAMERA_LIBCAMERA_MODULE_H
#define ISO_DRIVERS_SENSOR_LIBCAMERA_LIBCAMERA_MODULE_H

#include "drivers/base/module.h"
#include "drivers/sensor/libcamera/libcamera_pair.h"

#define ISO_LIBCAMERA_MODULE_NAME "libcamera"

struct iso_libcamera_module {
    struct iso_module module;
    __typeof__(iso_libcamera_pair_open) *open;
    __typeof__(iso_libcamera_pair_close) *close;
    __typeof__(iso_libcamera_list) *list;
    __typeof__(iso_libcamera_start) *start;
    __typeof__(iso_libcamera_stop) *stop;
    __typeof__(iso_libcamera_take) *take;
    __typeof__(iso_libcamera_give_back) *give_back;
    __typeof__(iso_libcamera_fd) *fd;
};

/* Loads the module, unless it is loaded. The errors of iso_module_load. */
int iso_libcamera_module_load(struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
