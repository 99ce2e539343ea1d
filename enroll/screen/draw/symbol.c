#include "enroll/screen/draw/symbol.h"

#include <math.h>
#include <stddef.h>

/* All shapes are drawn in a square from -1 to 1, y down. */

static void line(cairo_t *cairo, const double (*points)[2], int n)
{
    cairo_move_to(cairo, points[0][0], points[0][1]);
    for (int i = 1; i < n; i++) {
        cairo_line_to(cairo, points[i][0], points[i][1]);
    }
    cairo_stroke(cairo);
}

#define LINE(cairo, ...)                                            \
    do {                                                            \
        static const double points[][2] = {__VA_ARGS__};            \
        line(cairo, points, (int)(sizeof points / sizeof *points)); \
    } while (0)

static void circle(cairo_t *cairo, double x, double y, double radius)
{
    cairo_new_sub_path(cairo);
    cairo_arc(cairo, x, y, radius, 0.0, 2.0 * M_PI);
    cairo_stroke(cairo);
}

static void tick(cairo_t *cairo)
{
    circle(cairo, 0, 0, 0.9);
    LINE(cairo, {-0.42, 0.02}, {-0.1, 0.36}, {0.45, -0.32});
}

static void cross(cairo_t *cairo)
{
    circle(cairo, 0, 0, 0.9);
    LINE(cairo, {-0.36, -0.36}, {0.36, 0.36});
    LINE(cairo, {-0.36, 0.36}, {0.36, -0.36});
}

static void padlock(cairo_t *cairo)
{
    cairo_rectangle(cairo, -0.62, -0.12, 1.24, 0.98);
    cairo_stroke(cairo);
    cairo_arc(cairo, 0, -0.38, 0.4, M_PI, 2.0 * M_PI);
    cairo_line_to(cairo, 0.4, -0.12);
    cairo_move_to(cairo, -0.4, -0.38);
    cairo_line_to(cairo, -0.4, -0.12);
    cairo_stroke(cairo);
    LINE(cairo, {0, 0.26}, {0, 0.48});
}

static void clock_face(cairo_t *cairo)
{
    circle(cairo, 0, 0, 0.9);
    LINE(cairo, {0, -0.52}, {0, 0.02}, {0.36, 0.26});
}

static void wrench(cairo_t *cairo)
{
    /* A triangle with a mark, the sign for a fault. */
    LINE(cairo, {0, -0.82}, {0.92, 0.78}, {-0.92, 0.78}, {0, -0.82}, {0.46, -0.02});
    LINE(cairo, {0, -0.18}, {0, 0.28});
    LINE(cairo, {0, 0.54}, {0, 0.55});
}

static void arrow(cairo_t *cairo, double turn_rad)
{
    cairo_save(cairo);
    cairo_rotate(cairo, turn_rad);
    LINE(cairo, {-0.8, 0}, {0.8, 0});
    LINE(cairo, {0.25, -0.55}, {0.8, 0}, {0.25, 0.55});
    cairo_restore(cairo);
}

/* Corners that point in or out about a head. */
static void nearer(cairo_t *cairo)
{
    circle(cairo, 0, 0, 0.34);
    LINE(cairo, {-0.9, -0.5}, {-0.9, -0.9}, {-0.5, -0.9});
    LINE(cairo, {0.9, -0.5}, {0.9, -0.9}, {0.5, -0.9});
    LINE(cairo, {-0.9, 0.5}, {-0.9, 0.9}, {-0.5, 0.9});
    LINE(cairo, {0.9, 0.5}, {0.9, 0.9}, {0.5, 0.9});
}

static void farther(cairo_t *cairo)
{
    circle(cairo, 0, 0, 0.9);
    LINE(cairo, {-0.4, -0.1}, {-0.1, -0.1}, {-0.1, -0.4});
    LINE(cairo, {0.4, -0.1}, {0.1, -0.1}, {0.1, -0.4});
    LINE(cairo, {-0.4, 0.1}, {-0.1, 0.1}, {-0.1, 0.4});
    LINE(cairo, {0.4, 0.1}, {0.1, 0.1}, {0.1, 0.4});
}

static void person(cairo_t *cairo)
{
    circle(cairo, 0, -0.35, 0.42);
    cairo_arc(cairo, 0, 0.95, 0.75, M_PI, 2.0 * M_PI);
    cairo_stroke(cairo);
}

/* A mark of attention. */
static void mark(cairo_t *cairo)
{
    circle(cairo, 0, 0, 0.9);
    LINE(cairo, {0, -0.46}, {0, 0.12});
    LINE(cairo, {0, 0.44}, {0, 0.45});
}

static void draw_unit(cairo_t *cairo, enum screen_symbol symbol)
{
    switch (symbol) {
    case SCREEN_TICK:
        tick(cairo);
        break;
    case SCREEN_CROSS:
        cross(cairo);
        break;
    case SCREEN_PADLOCK:
        padlock(cairo);
        break;
    case SCREEN_CLOCK:
        clock_face(cairo);
        break;
    case SCREEN_WRENCH:
        wrench(cairo);
        break;
    case SCREEN_LEFT:
        arrow(cairo, M_PI);
        break;
    case SCREEN_RIGHT:
        arrow(cairo, 0.0);
        break;
    case SCREEN_UP:
        arrow(cairo, -M_PI / 2.0);
        break;
    case SCREEN_DOWN:
        arrow(cairo, M_PI / 2.0);
        break;
    case SCREEN_NEARER:
        nearer(cairo);
        break;
    case SCREEN_FARTHER:
        farther(cairo);
        break;
    case SCREEN_HAND:
        mark(cairo);
        break;
    case SCREEN_PERSON:
        person(cairo);
        break;
    case SCREEN_NO_SYMBOL:
    case SCREEN_SYMBOLS:
        break;
    }
}

void screen_symbol_draw(cairo_t *cairo, enum screen_symbol symbol, double x, double y, double side)
{
    cairo_save(cairo);
    cairo_translate(cairo, x, y);
    cairo_scale(cairo, 0.46 * side, 0.46 * side);
    cairo_set_line_width(cairo, 0.16);
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    draw_unit(cairo, symbol);
    cairo_restore(cairo);
}
