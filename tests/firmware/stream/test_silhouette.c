/* What those who watch can see of a frame: the outline of the mean head, the silhouette, the
 * relief. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/model/model_file.h"
#include "firmware/stream/head_outline.h"
#include "firmware/stream/silhouette.h"

struct scene {
    struct iso_head_model *model;
    struct iso_head_outline head;
    struct iso_frame *frame;
    struct iso_rigid pose;
};

enum { WIDTH = 640, HEIGHT = 480 };

static struct iso_frame *empty_frame(int width_px, int height_px)
{
    const struct iso_camera camera = {.projection = ISO_PINHOLE,
                                      .width_px = width_px,
                                      .height_px = height_px,
                                      .fx_px = 570,
                                      .fy_px = 570,
                                      .cx_px = 0.5 * (width_px - 1),
                                      .cy_px = 0.5 * (height_px - 1)};
    struct iso_frame *frame = NULL;
    assert_int_equal(iso_frame_new(&camera, width_px, height_px, false, &frame), 0);
    return frame;
}

/* A head that looks at the camera: x to the subject's left is x to the right of the picture, y up
 * is y down. */
static struct iso_rigid facing(double x_mm, double y_mm, double z_mm)
{
    return (struct iso_rigid){.rotation = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}},
                              .translation_mm = {x_mm, y_mm, z_mm}};
}

static int setup(void **state)
{
    struct scene *scene = calloc(1, sizeof *scene);
    assert_non_null(scene);
    assert_int_equal(
        iso_head_model_load(ISOTHERM_SOURCE_DIR "/core/data/head.model", &scene->model, NULL), 0);
    iso_head_outline_init(&scene->head, scene->model);
    scene->frame = empty_frame(WIDTH, HEIGHT);
    scene->pose = facing(0, 0, 600);
    *state = scene;
    return 0;
}

static int teardown(void **state)
{
    struct scene *scene = *state;
    iso_frame_free(scene->frame);
    iso_head_model_free(scene->model);
    free(scene);
    return 0;
}

static void fill(struct iso_frame *frame, int left, int top, int right, int bottom, float mm)
{
    for (int row = top; row < bottom; row++) {
        for (int column = left; column < right; column++) {
            frame->depth_mm[row * frame->width_px + column] = mm;
        }
    }
}

/* Above 0 if the corner at i turns clockwise on the screen. */
static double turn_at(int16_t xy[][2], int n, int i)
{
    const int16_t *a = xy[i];
    const int16_t *b = xy[(i + 1) % n];
    const int16_t *c = xy[(i + 2) % n];
    return (double)(b[0] - a[0]) * (c[1] - b[1]) - (double)(b[1] - a[1]) * (c[0] - b[0]);
}

/* Every vertex of the mean head lies within the outline, but for the rounding and the directions
 * between the 256. */
static void the_outline_surrounds_the_mean_head(void **state)
{
    struct scene *s = *state;
    int16_t xy[ISO_OUTLINE_POINTS][2];
    const struct iso_silhouette_scale scale = iso_silhouette_scale_of(s->frame);
    const int n = iso_head_outline_project(&s->head, &s->pose, s->frame, xy);
    assert_in_range(n, 12, ISO_OUTLINE_POINTS);
    for (int i = 0; i < n; i++) {
        assert_true(turn_at(xy, n, i) > -120.0); /* but for the rounding */
    }
    for (uint32_t v = 0; v < s->model->n_vertices; v++) {
        double column = 0.0;
        double row = 0.0;
        assert_true(iso_camera_project(
            &s->frame->camera, iso_rigid_apply(&s->pose, s->model->mean_mm[v]), &column, &row));
        const double x = (column + 0.5) / scale.px * ISO_OUTLINE_UNITS;
        const double y = (row + 0.5) / scale.px * ISO_OUTLINE_UNITS;
        for (int i = 0; i < n; i++) {
            const int16_t *a = xy[i];
            const int16_t *b = xy[(i + 1) % n];
            const double length = hypot(b[0] - a[0], b[1] - a[1]);
            const double outside = -((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) /
                                   length;
            assert_true(outside < 0.3 * ISO_OUTLINE_UNITS);
        }
    }
}

static int span(int16_t xy[][2], int n, int axis)
{
    int least = xy[0][axis];
    int most = xy[0][axis];
    for (int i = 1; i < n; i++) {
        least = xy[i][axis] < least ? xy[i][axis] : least;
        most = xy[i][axis] > most ? xy[i][axis] : most;
    }
    return most - least;
}

static void the_outline_follows_the_pose(void **state)
{
    struct scene *s = *state;
    int16_t near[ISO_OUTLINE_POINTS][2];
    int16_t far[ISO_OUTLINE_POINTS][2];
    const struct iso_rigid twice = facing(0, 0, 1200);
    const struct iso_rigid close = facing(0, 0, 50);
    const struct iso_rigid away = {.rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                                   .translation_mm = {0, 0, 50}};
    const int n = iso_head_outline_project(&s->head, &s->pose, s->frame, near);
    const int m = iso_head_outline_project(&s->head, &twice, s->frame, far);
    assert_true(abs(span(near, n, 0) - 2 * span(far, m, 0)) < span(far, m, 0) / 5);
    /* 151 mm wide; the widest part lies some 80 mm behind the nose: 15.8 points at 680 mm. */
    assert_true(abs(span(near, n, 0) - 506) < 30);
    assert_true(span(near, n, 1) > span(near, n, 0));
    /* The head reaches 104 mm behind its nose. Here this is behind the camera. */
    assert_true(iso_head_outline_project(&s->head, &close, s->frame, far) > 0);
    assert_int_equal(iso_head_outline_project(&s->head, &away, s->frame, far), 0);
}

static void a_model_without_vertices_gives_no_outline(void **state)
{
    struct scene *s = *state;
    const struct iso_head_model none = {.n_vertices = 0};
    struct iso_head_outline outline;
    int16_t xy[ISO_OUTLINE_POINTS][2];
    iso_head_outline_init(&outline, &none);
    assert_int_equal(outline.n, 0);
    assert_int_equal(iso_head_outline_project(&outline, &s->pose, s->frame, xy), 0);
}

static int count(uint8_t bits[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE], int left, int top,
                 int right, int bottom)
{
    int n = 0;
    for (int row = top; row < bottom; row++) {
        for (int column = left; column < right; column++) {
            n += iso_silhouette_is_set(bits, column, row);
        }
    }
    return n;
}

/* The nearest and farthest set points along an axis. */
static void extent(uint8_t bits[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE], int axis, int *least,
                   int *most)
{
    *least = 1000;
    *most = -1;
    for (int row = 0; row < ISO_SILHOUETTE_ROWS; row++) {
        for (int column = 0; column < ISO_SILHOUETTE_COLUMNS; column++) {
            const int at = axis == 0 ? column : row;
            if (iso_silhouette_is_set(bits, column, row)) {
                *least = at < *least ? at : *least;
                *most = at > *most ? at : *most;
            }
        }
    }
}

static void without_a_face_an_ellipse_shows_where_something_is(void **state)
{
    struct scene *s = *state;
    uint8_t bits[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE];
    int least = 0;
    int most = 0;
    iso_silhouette_draw(s->frame, NULL, 0, bits);
    assert_int_equal(count(bits, 0, 0, 80, 60), 0);
    fill(s->frame, 0, 0, WIDTH, HEIGHT, 2500.0F); /* a wall */
    iso_silhouette_draw(s->frame, NULL, 0, bits);
    assert_int_equal(count(bits, 0, 0, 80, 60), 0);
    fill(s->frame, 128, 160, 256, 352, 700.0F); /* 16 x 24 points about (24, 32) */
    iso_silhouette_draw(s->frame, NULL, 0, bits);
    assert_true(abs(count(bits, 0, 0, 80, 60) - 16 * 24) < 16 * 24 / 2);
    extent(bits, 0, &least, &most);
    assert_true(abs(least + most - 2 * 24) <= 5);
    extent(bits, 1, &least, &most);
    assert_true(abs(least + most - 2 * 32) <= 5);
}

/* What is finer than a cell of 4 points, which are 32 pixels here, changes nothing. */
static void details_finer_than_a_cell_are_not_shown(void **state)
{
    struct scene *s = *state;
    uint8_t plain[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE];
    uint8_t toothed[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE];
    fill(s->frame, 0, 0, 320, HEIGHT, 700.0F);
    iso_silhouette_draw(s->frame, NULL, 0, plain);
    assert_true(count(plain, 0, 0, 80, 60) > 0);
    for (int row = 0; row < HEIGHT; row += 16) {
        fill(s->frame, 320, row, 332, row + 8, 700.0F);
    }
    iso_silhouette_draw(s->frame, NULL, 0, toothed);
    assert_memory_equal(plain, toothed, sizeof plain);
}

/* Two people in the same pose: one with a large head, long hair and wide shoulders, one without. */
static void everybody_has_the_mean_head_and_shoulders(void **state)
{
    struct scene *s = *state;
    uint8_t large[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE];
    uint8_t small[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE];
    int16_t xy[ISO_OUTLINE_POINTS][2];
    const int n = iso_head_outline_project(&s->head, &s->pose, s->frame, xy);
    fill(s->frame, 200, 60, 440, HEIGHT, 640.0F);
    iso_silhouette_draw(s->frame, xy, n, large);
    fill(s->frame, 0, 0, WIDTH, HEIGHT, 0.0F);
    fill(s->frame, 260, 150, 380, 330, 640.0F);
    iso_silhouette_draw(s->frame, xy, n, small);
    assert_memory_equal(large, small, sizeof large);
    assert_true(iso_silhouette_is_set(large, 40, 30));
    assert_false(iso_silhouette_is_set(large, 30, 30)); /* beside the head */
    assert_true(iso_silhouette_is_set(large, 30, 58));  /* a shoulder */
    assert_false(iso_silhouette_is_set(large, 5, 58));
}

static void a_frame_of_other_proportions_lies_in_the_middle(void **state)
{
    (void)state;
    struct iso_frame *wide = empty_frame(1280, 720);
    const struct iso_silhouette_scale scale = iso_silhouette_scale_of(wide);
    assert_true(fabs(scale.px - 16.0) < 1e-9);
    assert_true(fabs(scale.left) < 1e-9 && fabs(scale.top - 7.5) < 1e-9);
    iso_frame_free(wide);
}

static void the_relief_is_small_and_has_millimetres(void **state)
{
    static struct iso_relief_record record;
    struct scene *s = *state;
    fill(s->frame, 0, 0, 320, HEIGHT, 700.4F);
    fill(s->frame, 320, 0, WIDTH, HEIGHT, 70000.0F);
    iso_relief_sample(s->frame, &record);
    assert_int_equal(record.columns, 160);
    assert_int_equal(record.rows, 120);
    assert_int_equal(record.depth_mm[60 * 160 + 79], 700);
    assert_int_equal(record.depth_mm[60 * 160 + 80], 0); /* too far for its number */
    struct iso_frame *odd = empty_frame(161, 99);
    fill(odd, 0, 0, 161, 99, 500.0F);
    iso_relief_sample(odd, &record);
    assert_int_equal(record.columns, 81);
    assert_int_equal(record.rows, 50);
    assert_int_equal(record.depth_mm[81 * 50 - 1], 500);
    iso_frame_free(odd);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(the_outline_surrounds_the_mean_head),
        TEST(the_outline_follows_the_pose),
        TEST(a_model_without_vertices_gives_no_outline),
        TEST(without_a_face_an_ellipse_shows_where_something_is),
        TEST(details_finer_than_a_cell_are_not_shown),
        TEST(everybody_has_the_mean_head_and_shoulders),
        TEST(a_frame_of_other_proportions_lies_in_the_middle),
        TEST(the_relief_is_small_and_has_millimetres),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
