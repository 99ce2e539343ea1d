#include "enroll/screen/draw/picture.h"

#include <libintl.h>
#include <math.h>

#include "enroll/screen/draw/outline.h"
#include "enroll/screen/draw/palette.h"
#include "enroll/screen/draw/symbol.h"
#include "enroll/screen/draw/text.h"

struct layout {
    double unit; /* the shorter side of the screen */
    bool upright;
    struct screen_box picture, words;
};

static struct layout layout_of(double width, double height, bool right_to_left)
{
    struct layout layout = {.unit = fmin(width, height), .upright = height > width};
    const double gap = 0.06 * layout.unit;
    if (layout.upright) {
        const double split = 0.56 * height;
        layout.picture = (struct screen_box){gap, gap, width - 2 * gap, split - gap};
        layout.words = (struct screen_box){gap, split + gap, width - 2 * gap,
                                           height - split - 2 * gap};
    } else {
        const double split = 0.46 * width;
        layout.picture = (struct screen_box){gap, gap, split - gap, height - 2 * gap};
        layout.words = (struct screen_box){split + gap, gap, width - split - 2 * gap,
                                           height - 2 * gap};
        if (right_to_left) {
            layout.picture.x = width - gap - layout.picture.width;
            layout.words.x = gap;
        }
    }
    return layout;
}

static void set_colour(cairo_t *cairo, struct screen_colour c)
{
    cairo_set_source_rgb(cairo, c.r, c.g, c.b);
}

/* Draws title and advice, one below the other, in the middle of the box's height. */
static void draw_words(cairo_t *cairo, const struct layout *layout,
                       const struct screen_palette *palette, const char *title, const char *advice)
{
    const struct screen_box *box = &layout->words;
    const struct screen_box above = {box->x, box->y, box->width, 0.62 * box->height};
    const struct screen_text first = {title, layout->unit / 9.0, true, layout->upright};
    const struct screen_text second = {advice, layout->unit / 13.5, false, layout->upright};
    const double gap = 0.05 * layout->unit;
    const double first_height = screen_text_height(cairo, &first, &above);
    const struct screen_box below = {box->x, 0, box->width, box->height - first_height - gap};
    const double second_height = *advice ? gap + screen_text_height(cairo, &second, &below) : 0.0;
    const double free_height = box->height - first_height - second_height;
    const double top = box->y + (layout->upright ? 0.15 : 0.5) * fmax(0.0, free_height);
    set_colour(cairo, palette->text);
    (void)screen_text_draw(cairo, &first,
                           &(struct screen_box){above.x, top, above.width, above.height});
    if (*advice) {
        set_colour(cairo, palette->quiet);
        (void)screen_text_draw(
            cairo, &second,
            &(struct screen_box){below.x, top + first_height + gap, below.width, below.height});
    }
}

static const char *translated(const char *text)
{
    return text && *text ? gettext(text) : "";
}

/* The fingerprint in lines of as many bytes as fit the screen: people compare it group by group. */
static void break_fingerprint(const char *fingerprint, size_t bytes_of_line, char *lines,
                              size_t size)
{
    const size_t line = 3 * bytes_of_line;
    size_t n = 0;
    for (size_t i = 0; fingerprint[i] && n + 2 < size; i++) {
        lines[n++] = fingerprint[i];
        if ((i + 1) % line == 0) {
            lines[n++] = '\n';
        }
    }
    lines[n] = '\0';
}

/* Where small texts stand at the lower edge. */
struct low {
    double width, height, unit; /* of the picture */
    double taken;               /* from the edge up, by the texts so far */
};

/* Draws a label and the lines under it, small, above what is there. */
static void draw_low(cairo_t *cairo, struct low *low, const struct screen_palette *palette,
                     const char *label_text, const char *lines)
{
    const double margin = 0.04 * low->unit;
    const double inner = low->width - 2 * margin;
    const struct screen_text label = {label_text, low->unit / 30.0, false, true};
    const struct screen_text text = {lines, low->unit / 30.0, false, true};
    const struct screen_box box = {margin, 0, inner, 0.12 * low->height};
    const double below = screen_text_height(cairo, &text, &box);
    const double above = screen_text_height(cairo, &label, &box);
    const double top = low->height - margin - low->taken - below - above;
    set_colour(cairo, palette->quiet);
    (void)screen_text_draw(cairo, &label, &(struct screen_box){margin, top, inner, above + 1.0});
    (void)screen_text_draw(cairo, &text,
                           &(struct screen_box){margin, top + above, inner, below + 1.0});
    low->taken += below + above;
}

/* What the web server says: its fingerprint, and above it the code. Returns the height that they
 * take. */
static double draw_web_server(cairo_t *cairo, const struct layout *layout, double width,
                              double height, const struct screen_palette *palette,
                              const struct screen_look *look)
{
    struct low low = {width, height, layout->unit, 0.0};
    char lines[160];

    if (*look->fingerprint) {
        break_fingerprint(look->fingerprint, layout->upright ? 8 : 16, lines, sizeof lines);
        draw_low(cairo, &low, palette, translated(N_("Certificate of the web server (SHA-256)")),
                 lines);
    }
    if (look->setup_code && *look->setup_code) {
        draw_low(cairo, &low, palette,
                 translated(N_("Code for the first account of the web server")), look->setup_code);
    }
    return low.taken;
}

/* The clock and the name of the place over the whole screen. What the web server says moves them
 * up. */
static void draw_idle(cairo_t *cairo, const struct layout *layout, double width, double height,
                      const struct screen_palette *palette, const struct screen_scene *scene,
                      const struct screen_look *look)
{
    const double margin = 0.08 * layout->unit;
    const double foot = fmax(margin, 0.055 * height); /* nothing is drawn in the lowest 5 % */
    const double inner = width - 2 * margin;
    const double below = draw_web_server(cairo, layout, width, height, palette, look);
    const bool moved = below > 0.0;
    const bool has_code = look->setup_code && *look->setup_code;
    const double size = has_code ? 0.18 : moved ? 0.26 : 0.34;
    const struct screen_text clock = {look->clock, size * layout->unit, true, true};
    const struct screen_text date = {look->date, layout->unit / 15.0, false, true};
    const struct screen_text place = {look->place, layout->unit / 13.5, false, true};
    const struct screen_text advice = {translated(scene->advice), layout->unit / 13.5, false, true};
    const struct screen_box whole = {margin, margin, inner, 0.4 * height};
    const double tall = screen_text_height(cairo, &clock, &whole);
    const double top = (has_code ? 0.31 : moved ? 0.36 : 0.46) * height - 0.5 * tall;
    set_colour(cairo, palette->quiet);
    (void)screen_text_draw(cairo, &place,
                           &(struct screen_box){margin, margin, inner, top - margin});
    set_colour(cairo, palette->text);
    (void)screen_text_draw(cairo, &clock, &(struct screen_box){margin, top, inner, tall});
    set_colour(cairo, palette->quiet);
    (void)screen_text_draw(cairo, &date,
                           &(struct screen_box){margin, top + tall, inner, 0.1 * height});
    set_colour(cairo, palette->accent);
    const struct screen_box end = {margin, 0, inner, (moved ? 0.13 : 0.24) * height};
    const double low = screen_text_height(cairo, &advice, &end);
    (void)screen_text_draw(
        cairo, &advice,
        &(struct screen_box){margin, height - foot - below - low, inner, low + 1.0});
}

static void draw_scene(cairo_t *cairo, const struct layout *layout,
                       const struct screen_palette *palette, const struct screen_scene *scene)
{
    const struct screen_box *box = &layout->picture;
    const double x = box->x + 0.5 * box->width;
    const double y = box->y + 0.5 * box->height;
    const bool person = scene->kind == SCREEN_NEAR || scene->kind == SCREEN_ENROL;
    if (person) {
        screen_outline_draw(cairo, &scene->outline, box, palette);
    }
    set_colour(cairo, palette->accent);
    if (person) {
        const double side = 0.2 * layout->unit;
        screen_symbol_draw(cairo, scene->symbol, x, box->y + box->height - 0.6 * side, side);
    } else {
        screen_symbol_draw(cairo, scene->symbol, x, y, 0.62 * fmin(box->width, box->height));
    }
    /* Under the name of the person stands the welcome. */
    if (*scene->person) {
        draw_words(cairo, layout, palette, scene->person, translated(scene->title));
    } else {
        draw_words(cairo, layout, palette, translated(scene->title), translated(scene->advice));
    }
}

void screen_picture_draw(cairo_t *cairo, int width_px, int height_px,
                         const struct screen_scene *scene, const struct screen_look *look)
{
    const struct screen_palette palette = screen_palette_of(scene->kind);
    const struct layout layout = layout_of(width_px, height_px, look->right_to_left);
    set_colour(cairo, palette.ground);
    cairo_paint(cairo);
    if (scene->kind == SCREEN_IDLE) {
        draw_idle(cairo, &layout, width_px, height_px, &palette, scene, look);
    } else {
        draw_scene(cairo, &layout, &palette, scene);
    }
}
