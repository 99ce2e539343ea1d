/* The shipped head model equals the result of the training, and has the required properties. The
 * tests need ISOTHERM_SHARED/data/ict-face, except the checks of the shipped file alone. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/surface/raster.h"
#include "drivers/file/png.h"
#include "drivers/model/model_file.h"
#include "sim/train/head/head_picture.h"
#include "sim/train/head/train_head.h"
#include "tests/support/scratch.h"
#include "tests/support/shared_data.h"

#define SHIPPED ISOTHERM_SOURCE_DIR "/core/data/head.model"

struct fixture {
    struct iso_head_model *shipped;
    struct sim_ict *ict; /* NULL: the data is missing */
};

static int setup(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    struct iso_fault fault;
    if (!f || iso_head_model_load(SHIPPED, &f->shipped, &fault) != 0) {
        free(f);
        return -1;
    }
    const char *path = shared_data("data/ict-face");
    *state = f;
    return scratch_exists(path) && sim_ict_load(path, &f->ict, &fault) != 0 ? -1 : 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    iso_head_model_free(f->shipped);
    sim_ict_free(f->ict);
    free(f);
    return 0;
}

static void training_makes_the_shipped_bytes(void **state)
{
    struct fixture *f = *state;
    if (!f->ict) {
        skip();
        return;
    }
    struct sim_train_head_options options = sim_train_head_options_default();
    struct sim_train_head_report report;
    struct iso_head_model *model = NULL;
    struct iso_fault fault;
    assert_int_equal(sim_train_head(f->ict, &options, &model, &report, &fault), 0);
    void *bytes = NULL;
    size_t size = 0, shipped_size = 0;
    assert_int_equal(iso_head_model_serialise(model, &bytes, &size), 0);
    void *shipped = scratch_read(SHIPPED, &shipped_size);
    assert_int_equal(size, shipped_size);
    assert_memory_equal(bytes, shipped, size);
    free(shipped);
    free(bytes);

    assert_int_equal(model->n_vertices, options.n_vertices);
    assert_true(report.decimation_mean_mm < 0.15 && report.decimation_p95_mm < 0.5);
    assert_true(report.identity_explained > 0.985 && report.identity_explained < 1.0);
    assert_true(report.expression_explained > 0.99 && report.expression_explained < 1.0);
    assert_true(report.unseen_rms_mm < 0.6 && report.identity_rms_mm > 4.0);
    /* The error for unseen people is as large as the modes' unexplained variance predicts. */
    double left = report.identity_rms_mm * sqrt(1.0 - report.identity_explained);
    assert_true(fabs(report.unseen_rms_mm - left) < 0.05);
    iso_head_model_free(model);
}

static void landmarks_are_those_of_the_head_model(void **state)
{
    struct fixture *f = *state;
    if (!f->ict) {
        skip();
        return;
    }
    const float *nose = f->ict->mean_mm + 3 * (size_t)f->ict->landmarks[30];
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        const float *v = f->ict->mean_mm + 3 * (size_t)f->ict->landmarks[i];
        struct iso_vec3 p = iso_head_point_on(f->shipped, f->shipped->mean_mm,
                                              f->shipped->landmarks[i]);
        assert_true(fabs(p.x - (double)(v[0] - nose[0])) < 1e-4);
        assert_true(fabs(p.y - (double)(v[1] - nose[1])) < 1e-4);
        assert_true(fabs(p.z - (double)(v[2] - nose[2])) < 1e-4);
    }
}

static void says_what_it_cannot_train(void **state)
{
    struct fixture *f = *state;
    if (!f->ict) {
        skip();
        return;
    }
    struct sim_train_head_options options = sim_train_head_options_default();
    struct sim_train_head_report report;
    struct iso_head_model *model = NULL;
    struct iso_fault fault;
    options.n_identity = 101;
    assert_int_equal(sim_train_head(f->ict, &options, &model, &report, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "too few modes"));
    options = sim_train_head_options_default();
    options.n_vertices = ISO_HEAD_VERTICES_MAX + 1;
    assert_int_equal(sim_train_head(f->ict, &options, &model, &report, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "out of range"));
    options = sim_train_head_options_default();
    uint32_t chin = f->ict->landmarks[8];
    f->ict->landmarks[8] = 11000; /* the back of the neck */
    assert_int_equal(sim_train_head(f->ict, &options, &model, &report, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "landmark"));
    f->ict->landmarks[8] = chin;
    assert_null(model);
}

enum { SIDE_PX = 241 };

/* The mean head seen from the front, with a pixel per millimetre and the nose tip in the centre. */
static void render_mean(const struct iso_head_model *model, float *depth_mm)
{
    struct iso_raster raster = {
        .camera = {.projection = ISO_ORTHOGRAPHIC,
                   .width_px = SIDE_PX,
                   .height_px = SIDE_PX,
                   .pitch_mm = 1.0,
                   .cx_px = (SIDE_PX - 1) * 0.5,
                   .cy_px = (SIDE_PX - 1) * 0.5},
        .width_px = SIDE_PX,
        .height_px = SIDE_PX,
        .depth_mm = depth_mm,
    };
    struct iso_vec3 *seen = calloc(model->n_vertices, sizeof *seen);
    assert_non_null(seen);
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        struct iso_vec3 p = model->mean_mm[i];
        seen[i] = iso_vec3(p.x, -p.y, 300.0 - p.z);
    }
    iso_raster_clear(&raster);
    iso_raster_triangles(&raster, seen, (const uint32_t(*)[3])model->triangles,
                         (int32_t)model->n_triangles, 0, 1.0, 1);
    free(seen);
}

static float at(const float *depth_mm, int x_mm, int y_mm)
{
    return depth_mm[(SIDE_PX / 2 - y_mm) * SIDE_PX + SIDE_PX / 2 + x_mm];
}

/* Marks the pixels that are connected to the empty pixel `start` without crossing the surface. */
static void flood(const float *depth_mm, uint8_t *outside, int start)
{
    static int stack[SIDE_PX * SIDE_PX];
    int n = 0;
    stack[n++] = start;
    outside[start] = 1;
    while (n > 0) {
        int pixel = stack[--n], column = pixel % SIDE_PX, row = pixel / SIDE_PX;
        const int next[4] = {column > 0 ? pixel - 1 : -1, column + 1 < SIDE_PX ? pixel + 1 : -1,
                             row > 0 ? pixel - SIDE_PX : -1,
                             row + 1 < SIDE_PX ? pixel + SIDE_PX : -1};
        for (int k = 0; k < 4; k++) {
            if (next[k] >= 0 && !outside[next[k]] && !(depth_mm[next[k]] > 0.0f)) {
                outside[next[k]] = 1;
                stack[n++] = next[k];
            }
        }
    }
}

/* Every empty pixel is connected to the outside, so that eyes and mouth are closed. */
static void the_mean_face_has_no_holes(void **state)
{
    struct fixture *f = *state;
    static float depth_mm[SIDE_PX * SIDE_PX];
    static uint8_t outside[SIDE_PX * SIDE_PX];
    render_mean(f->shipped, depth_mm);
    flood(depth_mm, outside, 0);
    for (int i = 0; i < SIDE_PX * SIDE_PX; i++) {
        if (!(depth_mm[i] > 0.0f) && !outside[i]) {
            fail_msg("hole at x = %d, y = %d mm", i % SIDE_PX - SIDE_PX / 2,
                     SIDE_PX / 2 - i / SIDE_PX);
        }
    }
    for (int y = -60; y <= 90; y += 10) { /* the face has a surface from brow to jaw */
        for (int x = -50; x <= 50; x += 10) {
            assert_true(at(depth_mm, x, y) > 0.0f);
        }
    }
    /* The face is so convex that the nose is in front. The eyes are a little behind the nasion, and
     * not at the back of their sockets. */
    float nose = at(depth_mm, 0, 0), eye = at(depth_mm, 32, 31), cheek = at(depth_mm, 40, 0);
    assert_true(nose < 302.0f && cheek > nose + 20.0f);
    assert_true(eye > nose + 25.0f && eye < nose + 42.0f);
}

static void modes_are_ordered_and_free_of_rigid_motion(void **state)
{
    struct fixture *f = *state;
    const struct iso_head_model *m = f->shipped;
    size_t stride = 3 * (size_t)m->n_vertices;
    assert_int_equal(m->n_identity, 60);
    assert_int_equal(m->n_expression, 12);
    double last = INFINITY;
    for (uint32_t k = 0; k < m->n_identity; k++) {
        double variance = 0.0;
        for (uint32_t t = 0; t < m->n_triangles; t++) {
            const uint32_t *v = m->triangles[t];
            struct iso_vec3 a = m->mean_mm[v[0]];
            struct iso_vec3 normal = iso_cross(iso_sub(m->mean_mm[v[1]], a),
                                               iso_sub(m->mean_mm[v[2]], a));
            for (int j = 0; j < 3; j++) {
                const float *d = m->identity_mm + k * stride + 3 * (size_t)v[j];
                double squared = (double)(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
                variance += m->region[v[j]] & ISO_HEAD_FACE ? iso_norm(normal) * squared : 0.0;
            }
        }
        assert_true(variance < last * 1.001); /* modes are rounded to int16 */
        last = variance;
    }
    for (uint32_t k = 0; k < m->n_identity; k++) {
        struct iso_vec3 mean_shift = {0, 0, 0};
        double spread = 0.0;
        int n = 0;
        for (uint32_t i = 0; i < m->n_vertices; i++) {
            const float *d = m->identity_mm + k * stride + 3 * (size_t)i;
            if (m->region[i] & ISO_HEAD_RIGID) {
                struct iso_vec3 p = {(double)d[0], (double)d[1], (double)d[2]};
                mean_shift = iso_add(mean_shift, p);
                spread += iso_dot(p, p);
                n++;
            }
        }
        assert_true(iso_norm(mean_shift) / n < 0.7 * sqrt(spread / n) + 1e-3);
    }
}

static bool in_region(const struct iso_head_model *m, struct iso_vec3 at_mm, uint8_t wanted)
{
    uint32_t nearest = 0;
    for (uint32_t i = 1; i < m->n_vertices; i++) {
        if (iso_norm(iso_sub(m->mean_mm[i], at_mm)) <
            iso_norm(iso_sub(m->mean_mm[nearest], at_mm))) {
            nearest = i;
        }
    }
    return (m->region[nearest] & wanted) == wanted;
}

static void regions_are_where_they_should_be(void **state)
{
    struct fixture *f = *state;
    const struct iso_head_model *m = f->shipped;
    struct iso_vec3 p[ISO_LANDMARKS_IBUG];
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        p[i] = iso_head_point_on(m, m->mean_mm, m->landmarks[i]);
    }
    const uint8_t rigid = ISO_HEAD_FACE | ISO_HEAD_RIGID;
    assert_true(in_region(m, p[27], rigid)); /* nasion */
    assert_true(in_region(m, p[30], rigid)); /* nose tip */
    for (int i = 48; i < 60; i++) {          /* the lips move; their inner sides are hidden */
        assert_true(in_region(m, p[i], ISO_HEAD_FACE) && !in_region(m, p[i], rigid));
    }
    static const int lids[] = {37, 38, 40, 41, 43, 44, 46, 47}; /* the eyelids move, too */
    int seen = 0;
    for (size_t k = 0; k < sizeof lids / sizeof *lids; k++) {
        assert_true(!in_region(m, p[lids[k]], rigid));
        seen += in_region(m, p[lids[k]], ISO_HEAD_FACE);
    }
    assert_true(seen >= 6); /* their folds hide the others */
    assert_true(in_region(m, p[8], ISO_HEAD_FACE) && !in_region(m, p[8], rigid)); /* chin */
    uint32_t n_face = 0, n_rigid = 0;
    for (uint32_t i = 0; i < m->n_vertices; i++) {
        n_face += (m->region[i] & ISO_HEAD_FACE) != 0;
        n_rigid += (m->region[i] & ISO_HEAD_RIGID) != 0;
        assert_true(!(m->region[i] & ISO_HEAD_RIGID) || (m->region[i] & ISO_HEAD_FACE));
        assert_true(!(m->region[i] & ISO_HEAD_FACE) || m->mean_mm[i].y < 75.0);
    }
    assert_true(n_face > 800 && n_face < m->n_vertices && n_rigid > 250 && n_rigid < n_face / 2);
}

static void pictures_show_a_face(void **state)
{
    struct fixture *f = *state;
    void *scratch = NULL;
    struct iso_fault fault;
    assert_int_equal(scratch_setup(&scratch), 0);
    assert_int_equal(sim_head_pictures(f->shipped, scratch, &fault), 0);
    assert_true(scratch_exists(scratch_path(scratch, "expression-5-plus.png")));
    assert_true(scratch_exists(scratch_path(scratch, "identity-1-minus.png")));
    struct iso_image image = {0};
    assert_int_equal(iso_png_read(scratch_path(scratch, "mean.png"), NULL, &image, &fault), 0);
    assert_int_equal(image.width_px, 2 * image.height_px); /* front and turned */
    const uint8_t *grey = image.samples;
    int n_lit = 0, n = image.width_px * image.height_px;
    for (int i = 0; i < n; i++) {
        n_lit += grey[i] > 60;
    }
    assert_true(n_lit > n / 10 && n_lit < n / 2);
    iso_image_done(&image);
    assert_int_equal(scratch_teardown(&scratch), 0);

    assert_int_equal(sim_head_pictures(f->shipped, "/nowhere/at/all", &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "/nowhere/at/all/mean.png"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(training_makes_the_shipped_bytes),
        cmocka_unit_test(landmarks_are_those_of_the_head_model),
        cmocka_unit_test(says_what_it_cannot_train),
        cmocka_unit_test(the_mean_face_has_no_holes),
        cmocka_unit_test(modes_are_ordered_and_free_of_rigid_motion),
        cmocka_unit_test(regions_are_where_they_should_be),
        cmocka_unit_test(pictures_show_a_face),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
