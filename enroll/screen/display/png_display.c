/* A display that writes files, for tests and pictures of documents. */
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "enroll/screen/display/display.h"

struct png {
    char directory[PATH_MAX - 32];
    cairo_surface_t *surface;
    unsigned n;
};

static cairo_surface_t *begin(void *self)
{
    return ((struct png *)self)->surface;
}

static int show(void *self)
{
    struct png *png = self;
    char path[PATH_MAX];
    (void)snprintf(path, sizeof path, "%s/%05u.png", png->directory, png->n);
    if (cairo_surface_write_to_png(png->surface, path) != CAIRO_STATUS_SUCCESS) {
        return -EIO;
    }
    png->n++;
    return 0;
}

static bool look(void *self)
{
    (void)self;
    return false;
}

static void close_png(void *self)
{
    struct png *png = self;
    cairo_surface_destroy(png->surface);
    free(png);
}

static const struct screen_display_ops ops = {begin, show, look, close_png, .looks_often = false};

int screen_display_png(const char *directory, int width_px, int height_px,
                       struct screen_display *out, struct iso_fault *fault)
{
    struct png *png = calloc(1, sizeof *png);
    if (!png) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    int error = 0;
    if (width_px < 16 || width_px > 4096 || height_px < 16 || height_px > 4096) {
        error = iso_fault_set(fault, -EINVAL, "a picture of %d x %d pixels: each must be 16..4096",
                              width_px, height_px);
    } else if (strlen(directory) >= sizeof png->directory) {
        error = iso_fault_set(fault, -ENAMETOOLONG, "%.40s...: the path is too long", directory);
    } else if (mkdir(directory, 0755) && errno != EEXIST) {
        error = iso_fault_set(fault, -errno, "%s: %s", directory, strerror(errno));
    }
    if (error) {
        free(png);
        return error;
    }
    (void)snprintf(png->directory, sizeof png->directory, "%s", directory);
    png->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px);
    *out = (struct screen_display){&ops, png};
    return 0;
}
