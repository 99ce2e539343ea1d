/* Draws a picture when it has changed, at most fifteen times a second. */
#ifndef ENROLL_SCREEN_PAINTER_H
#define ENROLL_SCREEN_PAINTER_H

#include <time.h>

#include "enroll/screen/display/display.h"
#include "enroll/screen/draw/picture.h"
#include "enroll/screen/fingerprint.h"
#include "enroll/screen/options.h"
#include "enroll/screen/scene/scene.h"

enum { SCREEN_PERIOD_MS = 66 };

/* All zero but `display` and `options`: nothing has been drawn. */
struct screen_painter {
    struct screen_display display;
    const struct screen_options *options;
    struct screen_scene_memory memory;
    struct screen_scene shown;           /* what is on the display */
    char clock[16], date[32];            /* the same */
    char print[SCREEN_FINGERPRINT_SIZE]; /* the same: the fingerprint of the web server */
    char code[SCREEN_FINGERPRINT_SIZE];  /* the same: the code for its first account */
    struct screen_fingerprint fingerprint, setup_code;
    bool drawn;
    unsigned pictures; /* how many were shown */
};

/* Shows the state at this monotonic time and this time of day, if it differs from what is shown.
 * `anew`: draws it in any case. */
void screen_painter_paint(struct screen_painter *painter, const struct screen_state *state,
                          int64_t now_ns, time_t time_of_day, bool anew);

/* Draws on a surface of any size, turned clockwise. */
void screen_paint_surface(cairo_surface_t *surface, int rotate, const struct screen_scene *scene,
                          const struct screen_look *look);

#endif
