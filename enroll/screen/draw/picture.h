/* Draws a scene (scene.h) on a cairo surface of any size: a picture on one side and words on the
 * other, or one above the other on an upright screen. Where the language is written from right to
 * left, the sides change places; the outline of the person is a mirror image in every language.
 *
 * Sizes follow the shorter side of the screen: the title is a ninth of it, which is 7 mm on a
 * screen of 5 inches with 800x480 pixels (65 mm high) and 24 minutes of arc at 1 m; advice is two
 * thirds of that. Letters of 16 minutes of arc are read with ease (ISO 9241-303). */
#ifndef ENROLL_SCREEN_DRAW_PICTURE_H
#define ENROLL_SCREEN_DRAW_PICTURE_H

#include <cairo.h>

#include "enroll/screen/scene/scene.h"

struct screen_look {
    const char *place;       /* the name of the place, UTF-8; "": none */
    const char *clock;       /* the time of day as it is shown, such as "14:05" */
    const char *date;        /* the date; "": none */
    const char *fingerprint; /* of the web server's certificate: "AB:CD:..."; "": none */
    const char *setup_code;  /* for its first account: "ABCDE-..."; "" and NULL: none */
    bool right_to_left;      /* the direction of the language */
};

/* Draws the whole picture, width x height pixels. */
void screen_picture_draw(cairo_t *cairo, int width_px, int height_px,
                         const struct screen_scene *scene, const struct screen_look *look);

#endif
