/* The device and the video mode that a session opens. */
#ifndef ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_WISH_H
#define ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_WISH_H

#include <stdbool.h>

enum iso__openni2_grey { ISO__OPENNI2_NO_GREY, ISO__OPENNI2_IR, ISO__OPENNI2_COLOR };

/* See sensor_openni2.h for the meaning of the options. */
struct iso__openni2_wish {
    const char *path;             /* an .oni file; NULL: a device */
    const char *device;           /* its URI or serial number; NULL: any */
    int width_px, height_px, fps; /* 0: as the device has it */
    int unit_um;                  /* 0: the finest that exists */
    bool loop;                    /* of a file */
    enum iso__openni2_grey grey;
};

#endif
