/* Draws every state in every language, at several sizes and turned. With a directory as its
 * argument it writes the pictures there, to be looked at. */
#include <libintl.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "enroll/screen/draw/palette.h"
#include "enroll/screen/draw/text.h"
#include "enroll/screen/language/language.h"
#include "enroll/screen/painter.h"

#define CATALOGUES ISOTHERM_BINARY_DIR "/enroll/screen/locale"

static const char *pictures; /* NULL: none are written */

/* A record with an oval head in the left half of the frame, which a mirror shows on the right. */
static struct iso_outline_record person(void)
{
    struct iso_outline_record record = {.distance_mm = 600, .n_points = 32, .hint = "move-left"};
    for (int i = 0; i < 32; i++) {
        const double angle = 2.0 * M_PI * i / 32;
        record.outline[i][0] = (int16_t)(ISO_OUTLINE_UNITS * (34.0 + 9.0 * cos(angle)));
        record.outline[i][1] = (int16_t)(ISO_OUTLINE_UNITS * (28.0 + 13.0 * sin(angle)));
    }
    for (int row = 0; row < ISO_SILHOUETTE_ROWS; row++) {
        for (int column = 0; column < ISO_SILHOUETTE_COLUMNS; column++) {
            const double x = (column - 34.0) / 9.0;
            const double y = (row - 28.0) / 13.0;
            const bool shoulder = row > 44 && fabs(column - 34.0) < 4.0 + 3.0 * sqrt(row - 44.0);
            if (x * x + y * y < 1.0 || shoulder) {
                record.silhouette[row][column / 8] |= (uint8_t)(0x80 >> column % 8);
            }
        }
    }
    return record;
}

struct story {
    const char *name;
    struct screen_state state;
};

enum { STORIES = 10, NOW = 500000000 };

static void tell_stories(struct story stories[STORIES])
{
    const struct screen_state idle = {.connected = true, .sees = true, .mode = "watch"};
    for (int i = 0; i < STORIES; i++) {
        stories[i].state = idle;
    }
    stories[0].name = "idle";
    stories[1].name = "near";
    stories[1].state.has_record = true;
    stories[1].state.record = person();
    stories[2].name = "allowed";
    stories[2].state.has_visit = stories[2].state.allowed = true;
    (void)snprintf(stories[2].state.person, SCREEN_PERSON_SIZE, "Anna-Sophia Übermüller");
    const char *const reasons[] = {"unknown", "not-valid", "attack", "stale"};
    for (int i = 0; i < 4; i++) {
        stories[3 + i].name = reasons[i];
        stories[3 + i].state.has_visit = true;
        (void)snprintf(stories[3 + i].state.reason, 16, "%s", reasons[i]);
    }
    stories[7].name = "lockdown";
    stories[7].state.lockdown = true;
    stories[8].name = "enrol";
    stories[8].state = stories[1].state;
    (void)snprintf(stories[8].state.mode, 12, "enroll");
    (void)snprintf(stories[8].state.record.hint, 20, "look-down");
    stories[9].name = "out-of-service";
    stories[9].state.connected = false;
}

static cairo_surface_t *draw_with(const struct screen_state *state, const char *language, int width,
                                  int height, int rotate, const char *fingerprint)
{
    const struct screen_look look = {
        .place = "Isotherm",
        .clock = "14:05",
        .date = "2026-11-24",
        .fingerprint = fingerprint,
        .right_to_left = screen_language_is_right_to_left(language),
    };
    struct screen_scene_memory memory = {.hint = NULL};
    const struct screen_scene scene = screen_scene_of(&memory, state, NOW);
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
    screen_paint_surface(surface, rotate, &scene, &look);
    cairo_surface_flush(surface);
    return surface;
}

static cairo_surface_t *draw(const struct screen_state *state, const char *language, int width,
                             int height, int rotate)
{
    return draw_with(state, language, width, height, rotate, "");
}

static uint32_t pixel(cairo_surface_t *surface, int x, int y)
{
    uint32_t value;
    const unsigned char *data = cairo_image_surface_get_data(surface);
    memcpy(&value, data + (ptrdiff_t)y * cairo_image_surface_get_stride(surface) + (ptrdiff_t)4 * x,
           sizeof value);
    return value & 0xffffff;
}

/* The share of pixels that differ from the ground, which is the colour of the corner. */
static double ink(cairo_surface_t *surface, int left, int top, int right, int bottom)
{
    const uint32_t ground = pixel(surface, 0, 0);
    size_t n = 0;
    for (int y = top; y < bottom; y++) {
        for (int x = left; x < right; x++) {
            n += pixel(surface, x, y) != ground;
        }
    }
    return (double)n / ((double)(right - left) * (bottom - top));
}

/* Something is drawn, and nothing touches the border. */
static void check_borders(cairo_surface_t *surface)
{
    const int w = cairo_image_surface_get_width(surface);
    const int h = cairo_image_surface_get_height(surface);
    assert_true(ink(surface, 0, 0, w, h) > 0.01);
    assert_true(ink(surface, 0, 0, w, h) < 0.6);
    assert_true(ink(surface, 0, 0, w, 3) == 0.0 && ink(surface, 0, h - 3, w, h) == 0.0);
    assert_true(ink(surface, 0, 0, 3, h) == 0.0 && ink(surface, w - 3, 0, w, h) == 0.0);
}

static void write_picture(cairo_surface_t *surface, const char *language, const char *name,
                          int width)
{
    char path[512];
    if (pictures) {
        (void)snprintf(path, sizeof path, "%s/%s-%s-%d.png", pictures, language, name, width);
        assert_int_equal(cairo_surface_write_to_png(surface, path), CAIRO_STATUS_SUCCESS);
    }
}

enum { SIZES = 5 };
static const int sizes[SIZES][2] = {{320, 240}, {240, 320}, {800, 480}, {480, 800}, {1920, 1080}};

static void every_state_fits_in_every_language_and_size(void **state)
{
    static struct story stories[STORIES];
    (void)state;
    tell_stories(stories);
    for (const char *const *language = screen_languages; *language; language++) {
        assert_int_equal(screen_language_set(*language, CATALOGUES), 0);
        for (size_t s = 0; s < SIZES; s++) {
            for (int i = 0; i < STORIES; i++) {
                cairo_surface_t *surface = draw(&stories[i].state, *language, sizes[s][0],
                                                sizes[s][1], 0);
                check_borders(surface);
                write_picture(surface, *language, stories[i].name, sizes[s][0]);
                cairo_surface_destroy(surface);
            }
        }
    }
}

/* The number of bands of ink that empty rows separate from each other. */
static int bands(cairo_surface_t *surface)
{
    const int w = cairo_image_surface_get_width(surface);
    int n = 0;
    bool inked = false;
    for (int y = 0; y < cairo_image_surface_get_height(surface); y++) {
        const bool ink_here = ink(surface, 0, y, w, y + 1) > 0.0;
        n += ink_here && !inked;
        inked = ink_here;
    }
    return n;
}

/* Place, clock, date, advice and fingerprint stand one below the other and do not touch. */
static void the_fingerprint_fits_below_the_rest(void **state)
{
    static const char print[] = "D0:D1:D2:D3:D4:D5:D6:D7:D8:D9:DA:DB:DC:DD:DE:DF:"
                                "B0:B1:B2:B3:B4:B5:B6:B7:B8:B9:BA:BB:BC:BD:BE:BF";
    static struct story stories[STORIES];
    (void)state;
    tell_stories(stories);
    for (const char *const *language = screen_languages; *language; language++) {
        assert_int_equal(screen_language_set(*language, CATALOGUES), 0);
        for (size_t s = 0; s < SIZES; s++) {
            const int w = sizes[s][0], h = sizes[s][1];
            cairo_surface_t *with = draw_with(&stories[0].state, *language, w, h, 0, print);
            cairo_surface_t *without = draw(&stories[0].state, *language, w, h, 0);
            check_borders(with);
            write_picture(with, *language, "idle-fingerprint", w);
            assert_true(bands(without) >= 4);
            assert_true(bands(with) >= 5);
            assert_true(ink(without, 0, h - h / 20, w, h) == 0.0);
            cairo_surface_destroy(with);
            cairo_surface_destroy(without);
        }
    }
}

static void a_turned_screen_shows_the_same_picture(void **state)
{
    static struct story stories[STORIES];
    (void)state;
    tell_stories(stories);
    assert_int_equal(screen_language_set("en", CATALOGUES), 0);
    cairo_surface_t *plain = draw(&stories[2].state, "en", 320, 240, 0);
    cairo_surface_t *half = draw(&stories[2].state, "en", 320, 240, 180);
    cairo_surface_t *quarter = draw(&stories[2].state, "en", 240, 320, 90);
    const double left = ink(plain, 0, 0, 160, 240);
    assert_true(left > 0.02);
    assert_true(fabs(ink(half, 160, 0, 320, 240) - left) < 0.01);
    assert_true(fabs(ink(quarter, 0, 0, 240, 160) - left) < 0.01);
    cairo_surface_destroy(plain);
    cairo_surface_destroy(half);
    cairo_surface_destroy(quarter);
}

/* In English the symbol is on the left, in Arabic on the right, where reading begins. */
static void arabic_changes_the_sides(void **state)
{
    static struct story stories[STORIES];
    (void)state;
    tell_stories(stories);
    assert_int_equal(screen_language_set("en", CATALOGUES), 0);
    cairo_surface_t *english = draw(&stories[7].state, "en", 800, 480, 0);
    assert_int_equal(screen_language_set("ar", CATALOGUES), 0);
    cairo_surface_t *arabic = draw(&stories[7].state, "ar", 800, 480, 0);
    const double symbol = ink(english, 93, 0, 303, 480);
    assert_true(symbol > 0.1);
    assert_true(fabs(ink(arabic, 800 - 303, 0, 800 - 93, 480) - symbol) < 0.01);
    assert_true(fabs(ink(arabic, 93, 0, 303, 480) - symbol) > 0.02);
    cairo_surface_destroy(arabic);
    cairo_surface_destroy(english);
}

/* No letter is missing in the fonts of this machine, but for Chinese ones, whose fonts are large
 * and only recommended. */
static void the_fonts_have_the_letters(void **state)
{
    (void)state;
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 800, 480);
    cairo_t *cairo = cairo_create(surface);
    static const char *const letters[] = {"Übermüller ñ ç é", "أهلاً وسهلاً"};
    for (size_t i = 0; i < 2; i++) {
        PangoLayout *layout = pango_cairo_create_layout(cairo);
        pango_layout_set_text(layout, letters[i], -1);
        assert_int_equal(pango_layout_get_unknown_glyphs_count(layout), 0);
        g_object_unref(layout);
    }
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
}

static void a_long_word_becomes_smaller(void **state)
{
    (void)state;
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 300, 100);
    cairo_t *cairo = cairo_create(surface);
    const struct screen_box box = {0, 0, 300, 100};
    const struct screen_text small = {"Hm", 40, true, false};
    const struct screen_text large = {"Donaudampfschifffahrtsgesellschaft", 40, true, false};
    const struct screen_text endless = {"many words and more words and more words and more words "
                                        "and more words and more words and more words and more "
                                        "words and more words and still more words",
                                        60, true, false};
    assert_true(screen_text_height(cairo, &large, &box) < screen_text_height(cairo, &small, &box));
    assert_true(screen_text_height(cairo, &endless, &box) <= 100.0);
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
}

static void a_language_that_is_missing_leaves_english(void **state)
{
    (void)state;
    assert_int_equal(screen_language_set("xx", CATALOGUES), -22);
    assert_int_equal(screen_language_set("de", "/nonexistent"), -2);
    assert_string_equal(gettext("Welcome"), "Welcome");
    assert_int_equal(screen_language_set("de", CATALOGUES), 0);
    assert_string_equal(gettext("Welcome"), "Willkommen");
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_state_fits_in_every_language_and_size),
        cmocka_unit_test(the_fingerprint_fits_below_the_rest),
        cmocka_unit_test(a_turned_screen_shows_the_same_picture),
        cmocka_unit_test(arabic_changes_the_sides),
        cmocka_unit_test(the_fonts_have_the_letters),
        cmocka_unit_test(a_long_word_becomes_smaller),
        cmocka_unit_test(a_language_that_is_missing_leaves_english),
    };
    pictures = argc > 1 ? argv[1] : NULL;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
