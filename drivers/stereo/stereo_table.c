/* The table that the module `stereo` exports. */
#include "drivers/stereo/stereo_module.h"

extern const struct iso_stereo_module iso_module;

ISO_MODULE_EXPORT const struct iso_stereo_module iso_module = {
    .module = ISO_MODULE(ISO_STEREO_MODULE_NAME, struct iso_stereo_module),
    .create = iso_stereo_opencv_new,
    .release = iso_stereo_opencv_free,
    .rectify = iso_stereo_opencv_rectify,
    .match = iso_stereo_opencv_match,
    .find_board = iso_board_opencv_find,
    .solve_board = iso_board_opencv_solve,
    .solve_board_single = iso_board_opencv_solve_single,
};
