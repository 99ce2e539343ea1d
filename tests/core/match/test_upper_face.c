/* The upper face of a template: its bytes, registration, fusion, and the fused score, on a surface
 * that is given by a formula. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/match/rerank.h"
#include "core/match/search.h"
#include "core/match/upper_face.h"
#include "core/match/upper_surface.h"

/* The working memory of the functions under test. */
static struct iso_rerank_workspace work;

/* A curved forehead with a nose, brows that are not symmetric, and a wave that depends on the
 * person. */
static double height_mm(int who, double x, double y)
{
    const double nose = 18.0 * exp(-(x * x + (y + 4.0) * (y + 4.0) / 3.0) / 250.0);
    const double brow = 5.0 *
                        exp(-((x - 25.0) * (x - 25.0) / 3.0 + (y - 35.0) * (y - 35.0)) / 90.0);
    return -0.006 * x * x - 0.003 * (y - 30.0) * (y - 30.0) + nose + brow +
           2.0 * sin(0.06 * (who + 1) * x) * cos(0.05 * who * y + 0.3);
}

static bool inside(double x, double y)
{
    return x * x / (64.0 * 64.0) + (y - 30.0) * (y - 30.0) / (54.0 * 54.0) < 1.0;
}

/* Returns the surface after a motion. An iteration finds the height above each node. */
static struct iso_upper_face moved_face(int who, const struct iso_rigid *motion)
{
    const struct iso_rigid back = iso_rigid_inverse(motion);
    struct iso_upper_face face;
    memset(&face, 0, sizeof face);
    for (int v = 0; v < ISO_UPPER_ROWS; v++) {
        for (int u = 0; u < ISO_UPPER_COLUMNS; u++) {
            struct iso_vec3 at = {0.0, 0.0, 0.0};
            double z = 0.0;
            for (int i = 0; i < 40; i++) {
                at = iso_rigid_apply(&back, iso_vec3(iso_upper_x_mm(u), iso_upper_y_mm(v), z));
                z = iso_rigid_apply(motion, iso_vec3(at.x, at.y, height_mm(who, at.x, at.y))).z;
            }
            if (inside(at.x, at.y)) {
                face.z_mm[v][u] = (float)z;
                face.kind[v][u] = ISO_UPPER_MEASURED;
            }
        }
    }
    return face;
}

static struct iso_upper_face face_of(int who)
{
    const struct iso_rigid still = iso_rigid_identity();
    return moved_face(who, &still);
}

static struct iso_rigid motion_of(double rx, double ry, double rz, double x, double y, double z)
{
    return (struct iso_rigid){iso_mat3_rotation(iso_vec3(rx, ry, rz)), {x, y, z}};
}

static void it_survives_its_bytes(void **state)
{
    (void)state;
    struct iso_upper_face face = face_of(1), back;
    face.kind[20][11] = ISO_UPPER_FILLED;
    static uint8_t bytes[ISO_UPPER_BYTES_MAX];
    assert_true(iso_upper_face_known(&face) && iso_upper_face_fits(&face));
    const size_t size = iso_upper_face_put(&face, bytes);
    assert_true(size > ISO_UPPER_KIND_BYTES && size < ISO_UPPER_BYTES_MAX);
    assert_int_equal(iso_upper_face_get(bytes, size, &back), 0);
    assert_memory_equal(back.kind, face.kind, sizeof face.kind);
    for (int v = 0; v < ISO_UPPER_ROWS; v++) {
        for (int u = 0; u < ISO_UPPER_COLUMNS; u++) {
            assert_true(fabsf(back.z_mm[v][u] - face.z_mm[v][u]) <= 0.5f / 64.0f + 1e-6f);
        }
    }
}

static void damaged_bytes_are_refused(void **state)
{
    (void)state;
    const struct iso_upper_face face = face_of(1);
    struct iso_upper_face back, untouched;
    static uint8_t bytes[ISO_UPPER_BYTES_MAX + 1];
    const size_t size = iso_upper_face_put(&face, bytes);
    memset(&back, 0x5a, sizeof back);
    untouched = back;
    for (size_t cut = 0; cut < size; cut++) {
        assert_int_equal(iso_upper_face_get(bytes, cut, &back), -EBADMSG);
    }
    assert_int_equal(iso_upper_face_get(bytes, size + 1, &back), -EBADMSG);
    bytes[200] |= 3; /* not a valid kind */
    assert_int_equal(iso_upper_face_get(bytes, size, &back), -EBADMSG);
    (void)iso_upper_face_put(&face, bytes);
    bytes[size - 1] = 0x80; /* 512 mm behind the nose tip */
    bytes[size - 2] = 0x00;
    assert_int_equal(iso_upper_face_get(bytes, size, &back), -EBADMSG);
    assert_memory_equal(&back, &untouched, sizeof back);
}

static void misfits_are_recognised(void **state)
{
    (void)state;
    struct iso_upper_face face = face_of(1), none;
    memset(&none, 0, sizeof none);
    assert_true(iso_upper_face_fits(&none) && !iso_upper_face_known(&none));
    none.kind[3][4] = ISO_UPPER_FILLED;
    assert_true(iso_upper_face_fits(&none) && !iso_upper_face_known(&none));
    face.z_mm[10][20] = NAN;
    assert_false(iso_upper_face_fits(&face));
    face = face_of(1);
    face.kind[10][20] = ISO_UPPER_NONE; /* with a height */
    assert_false(iso_upper_face_fits(&face));
    face = face_of(1);
    face.kind[10][20] = ISO_UPPER_MEASURED + 1;
    assert_false(iso_upper_face_fits(&face));
}

static void a_face_fits_itself_however_it_is_moved(void **state)
{
    (void)state;
    static const double motions[][6] = {
        {0, 0, 0, 0, 0, 4.0},        {0, 0, 0, 2.5, -1.5, 0},         {0.03, 0, 0, 0, 0, 0},
        {0, -0.04, 0, 1.0, 0, -2.0}, {0.02, 0.03, -0.03, -2, 1.5, 3}, {-0.03, 0.01, 0.05, 1, -2, 1},
    };
    const struct iso_upper_face still = face_of(2);
    struct iso_upper_surface surface;
    iso_upper_surface_of(&still, &surface);
    for (size_t i = 0; i < sizeof motions / sizeof *motions; i++) {
        const double *m = motions[i];
        const struct iso_rigid motion = motion_of(m[0], m[1], m[2], m[3], m[4], m[5]);
        const struct iso_upper_face moved = moved_face(2, &motion);
        struct iso_upper_fit fit;
        assert_int_equal(iso_upper_fit(&work.fit, &moved, &surface, &fit), 0);
        /* A motion along z moves nodes to nodes. With other motions the surface between the nodes
         * has the error of linear interpolation: an eighth of the curvature (up to 0.1 / mm) times
         * 3 mm squared. */
        assert_true(fit.rms_mm < (i == 0 ? 1e-3 : 0.06));
        assert_true(fit.overlap > 0.75 && fit.overlap <= 1.0); /* the slope of the rim is unknown */
        const struct iso_rigid whole = iso_rigid_mul(&fit.gallery_from_probe, &motion);
        const struct iso_vec3 corners[] = {{40, 60, -20}, {-40, 60, -20}, {0, -10, 15}};
        for (int k = 0; k < 3; k++) {
            const struct iso_vec3 at = iso_rigid_apply(&whole, corners[k]);
            assert_true(iso_norm(iso_sub(at, corners[k])) < 0.3);
        }
    }
}

static void another_face_fits_worse(void **state)
{
    (void)state;
    const struct iso_upper_face a = face_of(2), b = face_of(3);
    struct iso_upper_surface surface;
    struct iso_upper_fit fit;
    iso_upper_surface_of(&a, &surface);
    assert_int_equal(iso_upper_fit(&work.fit, &b, &surface, &fit), 0);
    assert_true(fit.rms_mm > 0.3);
}

static void too_small_an_overlap_is_reported(void **state)
{
    (void)state;
    const struct iso_upper_face whole = face_of(1);
    struct iso_upper_face left = whole, right = whole, none;
    struct iso_upper_surface surface;
    struct iso_upper_fit fit = {.rms_mm = 17.0};
    memset(&none, 0, sizeof none);
    for (int v = 0; v < ISO_UPPER_ROWS; v++) {
        for (int u = 0; u < ISO_UPPER_COLUMNS; u++) {
            struct iso_upper_face *without = u < ISO_UPPER_MIDDLE ? &right : &left;
            without->kind[v][u] = without->kind[v][u] ? ISO_UPPER_FILLED : ISO_UPPER_NONE;
        }
    }
    iso_upper_surface_of(&left, &surface);
    assert_int_equal(iso_upper_fit(&work.fit, &right, &surface, &fit), -ENODATA);
    assert_int_equal(iso_upper_fit(&work.fit, &none, &surface, &fit), -ENODATA);
    iso_upper_surface_of(&none, &surface);
    assert_int_equal(iso_upper_fit(&work.fit, &whole, &surface, &fit), -ENODATA);
    assert_true(fit.rms_mm == 17.0);
}

static void fusing_averages_in_the_frame_of_the_first(void **state)
{
    (void)state;
    const struct iso_rigid motion = motion_of(0.02, -0.02, 0.03, 1.5, -1.0, 2.0);
    struct iso_upper_face one = face_of(2), two = moved_face(2, &motion), none, fused;
    memset(&none, 0, sizeof none);
    for (int v = 0; v < ISO_UPPER_ROWS; v++) {
        for (int u = 0; u < ISO_UPPER_COLUMNS; u++) {
            const float off_mm = 0.4f;
            one.z_mm[v][u] += one.kind[v][u] ? off_mm : 0.0f;
            two.z_mm[v][u] -= two.kind[v][u] ? off_mm : 0.0f;
        }
    }
    one.kind[18][24] = ISO_UPPER_FILLED; /* the second has measured it */
    one.z_mm[18][24] += 9.0f;
    const struct iso_upper_face *faces[] = {&one, &two, &none};
    const struct iso_rigid first_from_face[] = {iso_rigid_identity(), iso_rigid_inverse(&motion),
                                                iso_rigid_identity()};
    iso_upper_face_fuse(faces, first_from_face, 3, &fused);
    assert_true(iso_upper_face_fits(&fused));
    int n = 0;
    for (int v = 4; v < ISO_UPPER_ROWS - 3; v++) {
        for (int u = 8; u < ISO_UPPER_COLUMNS - 8; u++) {
            const double x = iso_upper_x_mm(u), y = iso_upper_y_mm(v);
            if (x * x / (55.0 * 55.0) + (y - 30.0) * (y - 30.0) / (45.0 * 45.0) < 1.0) {
                const bool filled = v == 18 && u == 24;
                assert_int_equal(fused.kind[v][u], ISO_UPPER_MEASURED);
                assert_true(fabs((double)fused.z_mm[v][u] - height_mm(2, x, y)) <
                            (filled ? 0.7 : 0.2));
                n++;
            }
        }
    }
    assert_true(n > 400);
    iso_upper_face_fuse(faces + 2, first_from_face, 1, &fused);
    assert_memory_equal(&fused, &none, sizeof none);
}

/* A metric of one landmark and two dimensions, for which these templates differ little. */
static struct iso_metric *new_metric(void)
{
    const struct iso_metric shape = {
        .algorithm = 77,
        .landmarks = 1,
        .n_radii = 1,
        .n_points = 4,
        .n_dimensions = 2,
        .weight_min = 0.3f,
        .gain = 1.0f,
        .rerank = {.metric = 0.5f, .upper = 2.0f, .bias = 0.25f},
    };
    struct iso_metric *m = NULL;
    assert_int_equal(iso_metric_new(&shape, &m), 0);
    for (int v = 0; v < m->n_values; v++) {
        m->curve_mm[v] = 20.0f * (float)sin(1.7 * v);
        m->axis[2 * v] = (float)cos(0.3 * v);
        m->axis[2 * v + 1] = (float)cos(0.7 * v);
    }
    m->between[0] = 4.0f;
    m->between[1] = 2.0f;
    m->centre[0] = 2.0f; /* all are about as far from the average, in one direction */
    m->centre[1] = -1.0f;
    return m;
}

static struct iso_template template_of(const struct iso_metric *m, int who, float off_mm)
{
    struct iso_template t = {.algorithm = 77, .n_radii = 1, .n_points = 4, .n_frames = 1};
    for (int i = 0; i < 4; i++) {
        memcpy(t.points_mm[0][0][i], &m->curve_mm[3 * i], sizeof t.points_mm[0][0][i]);
        t.points_mm[0][0][i][2] += off_mm * (float)(i % 2);
        t.weight[0][0][i] = 1.0f;
    }
    t.upper = face_of(who);
    return t;
}

static void a_fused_score_is_the_weighted_sum(void **state)
{
    (void)state;
    struct iso_metric *m = new_metric();
    const struct iso_rigid motion = motion_of(0.01, 0.02, 0.0, 1.0, 0.0, 1.0);
    struct iso_upper_face probe = face_of(2);
    const struct iso_upper_face other = face_of(3), own = moved_face(2, &motion);
    const struct iso_upper_face *person[] = {&other, &own};
    double other_mm, own_mm, both_mm;
    assert_int_equal(iso_rerank_misfit(&work, &probe, &person[0], 1, &other_mm), 0);
    assert_int_equal(iso_rerank_misfit(&work, &probe, &person[1], 1, &own_mm), 0);
    assert_int_equal(iso_rerank_misfit(&work, &probe, person, 2, &both_mm), 0);
    assert_true(own_mm < other_mm && both_mm == own_mm);
    const double score = iso_rerank(&work, m, &probe, person, 2, 3.0);
    assert_true(fabs(score - (0.5 * 3.0 - 2.0 * log(own_mm) + 0.25)) < 1e-9);
    /* The misfit of a surface with itself is the smallest one, ISO_RERANK_RMS_MIN_MM. */
    assert_int_equal(
        iso_rerank_misfit(&work, &probe, (const struct iso_upper_face *[]){&probe}, 1, &own_mm), 0);
    assert_true(own_mm == ISO_RERANK_RMS_MIN_MM);
    /* Without surfaces, or without weights, it is the score of the metric. */
    assert_true(iso_rerank(&work, m, &probe, person, 0, 3.0) == 3.0);
    memset(&probe, 0, sizeof probe);
    assert_int_equal(iso_rerank_misfit(&work, &probe, person, 2, &own_mm), -ENODATA);
    assert_true(iso_rerank(&work, m, &probe, person, 2, 3.0) == 3.0);
    m->rerank = (struct iso_rerank_weights){0.0f, 0.0f, 0.0f};
    probe = face_of(2);
    assert_true(iso_rerank(&work, m, &probe, person, 2, 3.0) == 3.0);
    iso_metric_free(m);
}

/* Of several templates the misfit is that of the likeliest ones, wherever they stand. */
static void the_likeliest_templates_are_registered(void **state)
{
    (void)state;
    enum { TEMPLATES = 5 };
    const struct iso_rigid motion = motion_of(0.01, 0.02, 0.0, 1.0, 0.0, 1.0);
    const struct iso_upper_face probe = face_of(2), own = moved_face(2, &motion), none = {0};
    struct iso_upper_face others[TEMPLATES];
    double own_mm, found_mm;
    assert_int_equal(
        iso_rerank_misfit(&work, &probe, (const struct iso_upper_face *[]){&own}, 1, &own_mm), 0);
    for (int place = 0; place < TEMPLATES; place++) {
        const struct iso_upper_face *person[TEMPLATES];
        for (int i = 0; i < TEMPLATES; i++) {
            others[i] = i % 2 ? none : face_of(3 + i);
            person[i] = i == place ? &own : &others[i];
        }
        assert_int_equal(iso_rerank_misfit(&work, &probe, person, TEMPLATES, &found_mm), 0);
        assert_true(found_mm == own_mm);
    }
    const struct iso_upper_face *nothing[] = {&none, &none, &none};
    assert_int_equal(iso_rerank_misfit(&work, &probe, nothing, 3, &found_mm), -ENODATA);
}

/* A strip in the middle of the face, which resembles the whole but has too few points. */
static struct iso_upper_face strip_of(struct iso_upper_face face)
{
    for (int v = 0; v < ISO_UPPER_ROWS; v++) {
        memset(face.kind[v], ISO_UPPER_NONE, ISO_UPPER_MIDDLE - 5);
        memset(&face.kind[v][ISO_UPPER_MIDDLE + 6], ISO_UPPER_NONE, ISO_UPPER_MIDDLE - 5);
    }
    return face;
}

/* If the likeliest templates cannot be registered, others are. */
static void templates_that_cannot_be_registered_are_replaced(void **state)
{
    (void)state;
    const struct iso_rigid motion = motion_of(0.01, 0.02, 0.0, 1.0, 0.0, 1.0);
    const struct iso_upper_face probe = face_of(2), own = moved_face(2, &motion);
    const struct iso_upper_face other = face_of(3), strip = strip_of(probe);
    const struct iso_upper_face *person[] = {&strip, &other, &strip, &own, &other};
    double own_mm, found_mm;
    assert_int_equal(iso_rerank_misfit(&work, &probe, &person[3], 1, &own_mm), 0);
    assert_int_equal(iso_rerank_misfit(&work, &probe, person, 5, &found_mm), 0);
    assert_true(found_mm == own_mm);
}

/* Twelve people whom the metric distinguishes only a little, and in the wrong order. */
static void a_search_looks_again_at_the_best(void **state)
{
    (void)state;
    enum { PEOPLE = 12 };
    struct iso_metric *m = new_metric();
    static struct iso_template enrolled[PEOPLE];
    struct iso_search_entry entries[PEOPLE];
    const struct iso_template probe = template_of(m, 4, 0.0f);
    for (int i = 0; i < PEOPLE; i++) {
        enrolled[i] = template_of(m, i, 0.02f * (float)i);
        entries[i] = (struct iso_search_entry){100 + i, &enrolled[i]};
    }
    struct iso_search_hit hits[PEOPLE];
    struct iso_metric plain = *m;
    plain.rerank = (struct iso_rerank_weights){0.0f, 0.0f, 0.0f};
    int n = 0;
    assert_int_equal(iso_search_by_metric(&work, entries, PEOPLE, &probe, &plain, hits, PEOPLE, &n),
                     0);
    assert_int_equal(n, ISO_RERANK_CANDIDATES);
    assert_true(hits[0].person != 104);
    int64_t left_out = 0;
    for (int i = 0; i < PEOPLE; i++) {
        bool there = false;
        for (int k = 0; k < n; k++) {
            there = there || hits[k].person == 100 + i;
        }
        left_out = there ? left_out : 100 + i;
    }
    assert_int_equal(iso_search_by_metric(&work, entries, PEOPLE, &probe, m, hits, 2, &n), 0);
    assert_int_equal(n, 2);
    assert_int_equal(hits[0].person, 104);
    assert_true(hits[0].score > hits[1].score && hits[1].person != left_out);
    iso_metric_free(m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_survives_its_bytes),
        cmocka_unit_test(damaged_bytes_are_refused),
        cmocka_unit_test(misfits_are_recognised),
        cmocka_unit_test(a_face_fits_itself_however_it_is_moved),
        cmocka_unit_test(another_face_fits_worse),
        cmocka_unit_test(too_small_an_overlap_is_reported),
        cmocka_unit_test(fusing_averages_in_the_frame_of_the_first),
        cmocka_unit_test(a_fused_score_is_the_weighted_sum),
        cmocka_unit_test(the_likeliest_templates_are_registered),
        cmocka_unit_test(templates_that_cannot_be_registered_are_replaced),
        cmocka_unit_test(a_search_looks_again_at_the_best),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
