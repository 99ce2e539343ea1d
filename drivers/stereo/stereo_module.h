/* The module `stereo` is a shared object of its own (drivers/base/module.h) with the functions of
 * stereo_opencv.h and board_opencv.h. Programs call those functions directly; stereo_module.c
 * passes the calls to the module. */
#ifndef ISO_DRIVERS_STEREO_STEREO_MODULE_H
#define ISO_DRIVERS_STEREO_STEREO_MODULE_H

#include "drivers/base/module.h"
#include "drivers/stereo/board_opencv.h"
#include "drivers/stereo/stereo_opencv.h"

#define ISO_STEREO_MODULE_NAME "stereo"

struct iso_stereo_module {
    struct iso_module module;
    __typeof__(iso_stereo_opencv_new) *create;
    __typeof__(iso_stereo_opencv_free) *release;
    __typeof__(iso_stereo_opencv_rectify) *rectify;
    __typeof__(iso_stereo_opencv_match) *match;
    __typeof__(iso_board_opencv_find) *find_board;
    __typeof__(iso_board_opencv_solve) *solve_board;
    __typeof__(iso_board_opencv_solve_single) *solve_board_single;
};

#ifdef __cplusplus
extern "C" {
#endif

/* Loads the module, unless it is loaded. The errors of iso_module_load. */
int iso_stereo_module_load(struct iso_fault *fault) __attribute__((warn_unused_result));

#ifdef __cplusplus
}
#endif
#endif
