/* The table that the module `libcamera` exports. */
#include "drivers/sensor/libcamera/libcamera_module.h"

extern const struct iso_libcamera_module iso_module;

ISO_MODULE_EXPORT const struct iso_libcamera_module iso_module = {
    .module = ISO_MODULE(ISO_LIBCAMERA_MODULE_NAME, struct iso_libcamera_module),
    .open = iso_libcamera_pair_open,
    .close = iso_libcamera_pair_close,
    .list = iso_libcamera_list,
    .start = iso_libcamera_start,
    .stop = iso_libcamera_stop,
    .take = iso_libcamera_take,
    .give_back = iso_libcamera_give_back,
    .fd = iso_libcamera_fd,
};
