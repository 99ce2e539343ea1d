/* The upper face of a template: its bytes, registration and fusion. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/match/upper_face.h"
#include "core/match/upper_surface.h"
#include "tests/core/match/formula_face.h"

/* The working memory of the functions under test. */
static struct iso_upper_workspace work;

static void it_survives_its_bytes(void **state)
{
    (void)state;
    struct iso_upper_face face = formula_face(1), back;
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
    const struct iso_upper_face face = formula_face(1);
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
    struct iso_upper_face face = formula_face(1), none;
    memset(&none, 0, sizeof none);
    assert_true(iso_upper_face_fits(&none) && !iso_upper_face_known(&none));
    none.kind[3][4] = ISO_UPPER_FILLED;
    assert_true(iso_upper_face_fits(&none) && !iso_upper_face_known(&none));
    face.z_mm[10][20] = NAN;
    assert_false(iso_upper_face_fits(&face));
    face = formula_face(1);
    face.kind[10][20] = ISO_UPPER_NONE; /* with a height */
    assert_false(iso_upper_face_fits(&face));
    face = formula_face(1);
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
    const struct iso_upper_face still = formula_face(2);
    struct iso_upper_surface surface;
    iso_upper_surface_of(&still, &surface);
    for (size_t i = 0; i < sizeof motions / sizeof *motions; i++) {
        const double *m = motions[i];
        const struct iso_rigid motion = formula_face_motion(m[0], m[1], m[2], m[3], m[4], m[5]);
        const struct iso_upper_face moved = formula_face_moved(2, &motion);
        struct iso_upper_fit fit;
        assert_int_equal(iso_upper_fit(&work, &moved, &surface, &fit), 0);
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
    const struct iso_upper_face a = formula_face(2), b = formula_face(3);
    struct iso_upper_surface surface;
    struct iso_upper_fit fit;
    iso_upper_surface_of(&a, &surface);
    assert_int_equal(iso_upper_fit(&work, &b, &surface, &fit), 0);
    assert_true(fit.rms_mm > 0.3);
}

static void too_small_an_overlap_is_reported(void **state)
{
    (void)state;
    const struct iso_upper_face whole = formula_face(1);
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
    assert_int_equal(iso_upper_fit(&work, &right, &surface, &fit), -ENODATA);
    assert_int_equal(iso_upper_fit(&work, &none, &surface, &fit), -ENODATA);
    iso_upper_surface_of(&none, &surface);
    assert_int_equal(iso_upper_fit(&work, &whole, &surface, &fit), -ENODATA);
    assert_true(fit.rms_mm == 17.0);
}

static void fusing_averages_in_the_frame_of_the_first(void **state)
{
    (void)state;
    const struct iso_rigid motion = formula_face_motion(0.02, -0.02, 0.03, 1.5, -1.0, 2.0);
    struct iso_upper_face one = formula_face(2), two = formula_face_moved(2, &motion), none, fused;
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
                assert_true(fabs((double)fused.z_mm[v][u] - formula_face_height_mm(2, x, y)) <
                            (filled ? 0.7 : 0.2));
                n++;
            }
        }
    }
    assert_true(n > 400);
    iso_upper_face_fuse(faces + 2, first_from_face, 1, &fused);
    assert_memory_equal(&fused, &none, sizeof none);
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
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
