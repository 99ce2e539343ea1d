/* The preset `not-faces` has every kind of object, with the right name and the right shape. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/world/generate/not_faces.h"
#include "tests/sim/world/generated.h"
#include "tests/support/scratch.h"

enum { KINDS = 11, PER_KIND = 3 };

static const char *const kinds[KINDS] = {"back", "profile", "ear",  "hood",  "hand",   "wall",
                                         "ball", "chair",   "coat", "plant", "cushion"};

/* One corpus for all tests that only read it. */
static struct sim_corpus *shared_corpus;
static char shared_directory[256];

static const struct sim_corpus *corpus(void **state)
{
    if (!shared_corpus) {
        (void)snprintf(shared_directory, sizeof shared_directory, "%s",
                       scratch_path(*state, "corpus"));
        struct sim_generate_options options = generated_options("not-faces", shared_directory);
        options.n_per_kind = PER_KIND;
        shared_corpus = generated_corpus(&options);
    }
    return shared_corpus;
}

static int tear_down(void **state)
{
    sim_corpus_free(shared_corpus);
    return scratch_teardown(state);
}

static void rows_are_as_documented(void **state)
{
    const struct sim_corpus *c = corpus(state);
    assert_int_equal(c->n_rows, KINDS * PER_KIND);
    assert_int_equal(c->n_rows, sim_not_faces_count(PER_KIND));
    for (size_t i = 0; i < c->n_rows; i++) {
        const struct sim_corpus_row *row = &c->rows[i];
        assert_string_equal(row->note, kinds[i / PER_KIND]);
        assert_string_equal(row->subject, "none");
        assert_int_equal(row->role, SIM_ROLE_PROBE);
        assert_int_equal(row->count, 1);
        assert_true(row->expression[0] != '\0');
    }
}

/* A scene depends only on its number. */
static void the_same_options_make_the_same_bytes(void **state)
{
    (void)corpus(state);
    char again[256], file[128];
    (void)strcpy(again, scratch_path(*state, "again"));
    struct sim_generate_options options = generated_options("not-faces", again);
    options.n_per_kind = 1;
    sim_corpus_free(generated_corpus(&options));
    for (int k = 0; k < KINDS; k++) {
        (void)snprintf(file, sizeof file, "none-%s-0000/depth/000000.png", kinds[k]);
        assert_true(generated_same(shared_directory, again, file));
    }
}

/* An object of the expected size is at the place where people stand: a share of the image is as
 * near as they are, and there is no ground truth of a face. */
static void an_object_is_at_the_place_of_a_person(void **state)
{
    const struct sim_corpus *c = corpus(state);
    char file[128];
    for (size_t i = 0; i < c->n_rows; i++) {
        struct iso_frame *frame = generated_frame(shared_directory, c->rows[i].recording, 0);
        int n = frame->width_px * frame->height_px, near = 0;
        for (int k = 0; k < n; k++) {
            near += frame->depth_mm[k] > 0.0f && frame->depth_mm[k] < 1250.0f;
        }
        double share = (double)near / n;
        print_message("%s %s: %.3f of the image\n", c->rows[i].recording, c->rows[i].expression,
                      share);
        assert_true(share > 0.015);
        (void)snprintf(file, sizeof file, "%s/landmarks.csv", c->rows[i].recording);
        assert_false(scratch_exists(scratch_path(shared_directory, file)));
        iso_frame_free(frame);
    }
}

/* A fine sensor without noise measures geometry that has a closed form. */
static struct sim_generate_options exact(const char *directory)
{
    struct sim_generate_options options = generated_options("not-faces", directory);
    options.sensor = &sim_sensor_truedepth;
    options.noise_scale = 0.0;
    options.n_per_kind = 8;
    return options;
}

/* Returns the radius of the sphere about the nearest point: |p|^2 = 2 c.p + d by least squares. */
static double sphere_radius(const struct iso_frame *frame)
{
    int nearest = -1, n = frame->width_px * frame->height_px;
    for (int k = 0; k < n; k++) {
        bool measured = frame->depth_mm[k] > 0.0f;
        nearest = measured && (nearest < 0 || frame->depth_mm[k] < frame->depth_mm[nearest])
                      ? k
                      : nearest;
    }
    assert_true(nearest >= 0);
    int u0 = nearest % frame->width_px, v0 = nearest / frame->width_px, half = 60;
    struct iso_vec3 middle = generated_point(frame, u0, v0);
    double a[6][7] = {{0}};
    for (int k = 0; k < (2 * half + 1) * (2 * half + 1); k++) {
        int u = u0 - half + k % (2 * half + 1), v = v0 - half + k / (2 * half + 1);
        struct iso_vec3 p = generated_point(frame, u, v);
        struct iso_vec3 q = iso_sub(p, middle);
        double terms[4] = {q.x, q.y, q.z, 1.0}, square = iso_dot(q, q);
        for (int r = 0; p.z > 0.0 && q.z < 30.0 && r < 4; r++) {
            for (int c = 0; c < 4; c++) {
                a[r][c] += terms[r] * terms[c];
            }
            a[r][6] += terms[r] * square;
        }
    }
    generated_solve(a, 4);
    struct iso_vec3 centre = iso_scale(0.5, iso_vec3(a[0][6], a[1][6], a[2][6]));
    return sqrt(a[3][6] + iso_dot(centre, centre));
}

/* Returns the largest distance between the middle part of the image and the plane through it. */
static double plane_residual(const struct iso_frame *frame)
{
    double a[6][7] = {{0}}, worst = 0.0;
    int u0 = frame->width_px / 2, v0 = frame->height_px / 2, half = 100;
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < (2 * half + 1) * (2 * half + 1); k++) {
            int u = u0 - half + k % (2 * half + 1), v = v0 - half + k / (2 * half + 1);
            struct iso_vec3 p = generated_point(frame, u, v);
            double terms[3] = {p.x, p.y, 1.0}, z = p.z;
            for (int r = 0; p.z > 0.0 && r < 3; r++) {
                for (int c = 0; pass == 0 && c < 3; c++) {
                    a[r][c] += terms[r] * terms[c];
                }
                a[r][6] += pass == 0 ? terms[r] * p.z : 0.0;
                z -= pass == 1 ? a[r][6] * terms[r] : 0.0;
            }
            worst = pass == 1 && p.z > 0.0 ? fmax(worst, fabs(z)) : worst;
        }
        if (pass == 0) {
            generated_solve(a, 3);
        }
    }
    return worst;
}

static void balls_are_round_and_walls_are_flat(void **state)
{
    char directory[256];
    (void)strcpy(directory, scratch_path(*state, "exact"));
    struct sim_generate_options options = exact(directory);
    struct sim_corpus *corpus = generated_corpus(&options);
    int balls = 0, flat = 0, bent = 0;
    for (size_t i = 0; i < corpus->n_rows; i++) {
        const struct sim_corpus_row *row = &corpus->rows[i];
        struct iso_frame *frame = generated_frame(directory, row->recording, 0);
        double radius;
        if (sscanf(row->expression, "ball-r%lf", &radius) == 1) {
            double measured = sphere_radius(frame);
            print_message("%s: measured %.1f\n", row->expression, measured);
            assert_true(fabs(measured / radius - 1.0) < 0.04);
            balls++;
        } else if (strcmp(row->note, "wall") == 0) {
            double residual = plane_residual(frame);
            bool plain = strcmp(row->expression, "plain") == 0 ||
                         strcmp(row->expression, "slanted") == 0;
            print_message("wall %s: within %.2f mm of a plane\n", row->expression, residual);
            assert_true(plain ? residual < 2.0 : residual > 5.0);
            flat += plain;
            bent += !plain;
        }
        iso_frame_free(frame);
    }
    assert_true(balls >= 3 && flat >= 1 && bent >= 3);
    sim_corpus_free(corpus);
}

static void people_are_turned_away(void **state)
{
    static const struct {
        const char *note;
        double least, most;
    } turns[] = {{"back", 150, 180}, {"profile", 80, 110}, {"ear", 75, 105}, {"hood", 85, 180}};
    const struct sim_corpus *c = corpus(state);
    int n = 0, left = 0;
    for (size_t i = 0; i < c->n_rows; i++) {
        for (size_t k = 0; k < sizeof turns / sizeof *turns; k++) {
            double turn;
            if (strcmp(c->rows[i].note, turns[k].note) == 0) {
                assert_int_equal(sscanf(c->rows[i].expression, "turned%lf", &turn), 1);
                assert_true(fabs(turn) >= turns[k].least && fabs(turn) <= turns[k].most);
                left += turn > 0.0;
                n++;
            }
        }
    }
    assert_int_equal(n, 4 * PER_KIND);
    assert_true(left >= 1 && left < n);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_as_documented),
        cmocka_unit_test(the_same_options_make_the_same_bytes),
        cmocka_unit_test(an_object_is_at_the_place_of_a_person),
        cmocka_unit_test(balls_are_round_and_walls_are_flat),
        cmocka_unit_test(people_are_turned_away),
    };
    return cmocka_run_group_tests(tests, scratch_setup, tear_down);
}
