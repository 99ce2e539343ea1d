/* Two cameras through libcamera. The .cc file is C++, this header is C; no exception leaves it. The
 * code is in the module `libcamera` (libcamera_module.h). libcamera runs a thread of its own, which
 * fills a queue behind a lock; everything else happens in the caller's thread.
 *
 * libcamera allows one manager in a process: while a pair is open, opening another one returns
 * -EBUSY. */
#ifndef ISO_DRIVERS_SENSOR_LIBCAMERA_LIBCAMERA_PAIR_H
#define ISO_DRIVERS_SENSOR_LIBCAMERA_LIBCAMERA_PAIR_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct iso_libcamera_pair;

struct iso_libcamera_options {
    const char *ids[2]; /* of the cameras, as libcamera names them (`cam --list`) */
    int width_px, height_px;
    int fps; /* 0: the cameras' own rate */
};

enum { ISO_LIBCAMERA_TEXT = 200 };

/* Acquires both cameras and sets them up for grey pictures (R8, R12, R10, YUYV) without streaming.
 * On failure `text` says what failed. -ENODEV there is no such camera (the text lists the existing
 * ones); -EBUSY another process has it, another pair is open, or another thread lists the cameras;
 * -EINVAL it has no such picture format, -ENOMEM, -EIO, the errors of iso_libcamera_module_load. */
int iso_libcamera_pair_open(const struct iso_libcamera_options *options,
                            struct iso_libcamera_pair **out, char text[ISO_LIBCAMERA_TEXT])
    __attribute__((warn_unused_result));

/* Closes it. NULL is accepted. */
void iso_libcamera_pair_close(struct iso_libcamera_pair *pair);

/* Calls `tell` for every camera that libcamera sees, with its name and its model. May be called
 * while a pair is open. 0 also if there is no camera; -EBUSY another thread opens a pair or lists
 * the cameras, -EIO, -ENOMEM, the errors of iso_libcamera_module_load. */
int iso_libcamera_list(void (*tell)(const char *id, const char *model, void *context),
                       void *context) __attribute__((warn_unused_result));

/* Operations of camera 0 or 1: start, stop, take, give_back and fd of picture_source.h. -EIO,
 * -ENODEV and the other errors of the operation of the same name. */
int iso_libcamera_start(struct iso_libcamera_pair *pair, int camera)
    __attribute__((warn_unused_result));
int iso_libcamera_stop(struct iso_libcamera_pair *pair, int camera);

/* A picture; its bytes stay valid until iso_libcamera_give_back. */
struct iso_libcamera_picture {
    const uint8_t *bytes;
    size_t size_bytes, stride_bytes;
    uint32_t fourcc; /* DRM_FORMAT_... */
    int width_px, height_px;
    uint32_t sequence;
    int64_t stamp_ns; /* of CLOCK_MONOTONIC */
};

int iso_libcamera_take(struct iso_libcamera_pair *pair, int camera,
                       struct iso_libcamera_picture *out) __attribute__((warn_unused_result));
int iso_libcamera_give_back(struct iso_libcamera_pair *pair, int camera)
    __attribute__((warn_unused_result));
int iso_libcamera_fd(const struct iso_libcamera_pair *pair, int camera);

#ifdef __cplusplus
}
#endif
#endif
