/* Where the picture goes: a monitor (KMS), a window on a desktop, or a directory of PNG files. */
#ifndef ENROLL_SCREEN_DISPLAY_DISPLAY_H
#define ENROLL_SCREEN_DISPLAY_DISPLAY_H

#include <cairo.h>
#include <stdbool.h>

#include "core/base/fault.h"

struct screen_display_ops {
    /* The surface to draw the next picture on, or NULL: there is none now (no monitor is connected,
     * or the last picture is not shown yet). It belongs to the display. */
    cairo_surface_t *(*begin)(void *self);

    /* Shows what was drawn. 0, or a negative errno: the picture is lost, and the next one may be
     * shown again. */
    int (*show)(void *self);

    /* Looks whether a monitor was connected or lost, or a window has another size. Called each
     * second; with looks_often, as often as a picture may be drawn. Returns true if the picture has
     * to be drawn anew. */
    bool (*look)(void *self);

    void (*close)(void *self);
    bool looks_often;
};

struct screen_display {
    const struct screen_display_ops *ops;
    void *self;
};

/* Writes each picture to DIRECTORY/NNNNN.png, from 00000 on. -ENOMEM; -EINVAL for a size outside
 * 16..4096 pixels; or why the directory cannot be made. */
int screen_display_png(const char *directory, int width_px, int height_px,
                       struct screen_display *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The first monitor of the first graphics card that has one, in its preferred mode, by two dumb
 * buffers of the kernel's mode setting. `device` is "/dev/dri/card0", or "" for the first that can
 * be used. It succeeds without a monitor or a card, too, and looks for them each second. -ENOMEM.
 */
int screen_display_kms(const char *device, struct screen_display *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* A window of this size on the Wayland or X11 desktop of the user. The user may give it another
 * size; closing it sends SIGTERM to the program. -ENOMEM; -ENOENT: SDL is not installed; -ENODEV:
 * there is no desktop. */
int screen_display_window(int width_px, int height_px, struct screen_display *out,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

/* Closes and clears it. It may be all zero. */
void screen_display_close(struct screen_display *display);

#endif
