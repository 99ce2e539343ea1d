#include "enroll/screen/painter.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "enroll/screen/language/language.h"

void screen_paint_surface(cairo_surface_t *surface, int rotate, const struct screen_scene *scene,
                          const struct screen_look *look)
{
    const int width = cairo_image_surface_get_width(surface);
    const int height = cairo_image_surface_get_height(surface);
    const bool turned = rotate % 180 != 0;
    cairo_t *cairo = cairo_create(surface);
    cairo_translate(cairo, 0.5 * width, 0.5 * height);
    cairo_rotate(cairo, rotate * M_PI / 180.0);
    cairo_translate(cairo, -0.5 * (turned ? height : width), -0.5 * (turned ? width : height));
    screen_picture_draw(cairo, turned ? height : width, turned ? width : height, scene, look);
    cairo_destroy(cairo);
}

/* Whether two scenes look the same. */
static bool is_same(const struct screen_scene *a, const struct screen_scene *b)
{
    return a->kind == b->kind && a->title == b->title && a->advice == b->advice &&
           a->symbol == b->symbol && strcmp(a->person, b->person) == 0 &&
           a->outline.n_points == b->outline.n_points &&
           memcmp(a->outline.outline, b->outline.outline, sizeof a->outline.outline) == 0 &&
           memcmp(a->outline.silhouette, b->outline.silhouette, sizeof a->outline.silhouette) == 0;
}

void screen_painter_paint(struct screen_painter *painter, const struct screen_state *state,
                          int64_t now_ns, time_t time_of_day, bool anew)
{
    char clock[sizeof painter->clock] = "";
    char date[sizeof painter->date] = "";
    const char *fingerprint = "", *code = "";
    struct tm local;
    const struct screen_options *options = painter->options;
    const struct screen_scene scene = screen_scene_of(&painter->memory, state, now_ns);
    if (scene.kind == SCREEN_IDLE && localtime_r(&time_of_day, &local)) {
        (void)strftime(clock, sizeof clock, "%H:%M", &local);
        (void)strftime(date, sizeof date, "%Y-%m-%d", &local);
        fingerprint = screen_fingerprint_look(&painter->fingerprint, options->fingerprint, now_ns);
        code = screen_setup_code_look(&painter->setup_code, options->setup_code, now_ns);
    }
    if (!anew && painter->drawn && is_same(&scene, &painter->shown) &&
        strcmp(clock, painter->clock) == 0 && strcmp(fingerprint, painter->print) == 0 &&
        strcmp(code, painter->code) == 0) {
        return;
    }
    cairo_surface_t *surface = painter->display.ops->begin(painter->display.self);
    if (!surface) {
        return;
    }
    const struct screen_look look = {
        .place = options->place,
        .clock = clock,
        .date = date,
        .fingerprint = fingerprint,
        .setup_code = code,
        .right_to_left = screen_language_is_right_to_left(options->language),
    };
    screen_paint_surface(surface, options->rotate, &scene, &look);
    painter->drawn = painter->display.ops->show(painter->display.self) == 0;
    painter->pictures += painter->drawn;
    if (options->verbose && (scene.kind != painter->shown.kind ||
                             scene.title != painter->shown.title || painter->pictures == 1)) {
        printf("%s: %s\n", screen_scene_name(scene.kind), scene.title ? scene.title : clock);
        (void)fflush(stdout);
    }
    painter->shown = scene;
    memcpy(painter->clock, clock, sizeof clock);
    memmove(painter->print, fingerprint, strlen(fingerprint) + 1);
    memmove(painter->code, code, strlen(code) + 1);
}
