/* Every method on faces whose shape is known: smooth hills that differ from person to person. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/base/random.h"
#include "sim/lab/methods/anthroface.h"
#include "sim/lab/methods/geodesic.h"
#include "sim/lab/methods/method.h"

enum { SIDE = 61 }; /* 3 mm apart: 90 mm about the middle */
static const double spacing_mm = 3.0, radius_mm = 86.0;

typedef double surface(const void *context, double x, double y);

static struct sim_scan *draw(surface *z, const void *context)
{
    struct sim_scan *scan = NULL;
    assert_int_equal(sim_scan_new(SIDE, spacing_mm, &scan), 0);
    for (int row = 0; row < SIDE; row++) {
        for (int column = 0; column < SIDE; column++) {
            struct iso_vec3 p = sim_scan_point(scan, column, row);
            if (hypot(p.x, p.y) <= radius_mm) {
                scan->z_mm[row * SIDE + column] = (float)z(context, p.x, p.y);
                scan->measured[row * SIDE + column] = 1;
            }
        }
    }
    return scan;
}

/* A head-like dome with a nose and hills of a person; the twelve landmarks stand on it. */
struct person {
    uint64_t key;
    double noise_mm, yaw_rad;
    struct sim_random *random;
};

static double relief(const void *context, double x, double y)
{
    const struct person *p = context;
    struct sim_random shape = sim_random_seeded(7, p->key, 0);
    double tilted = x * cos(p->yaw_rad), z = -(tilted * tilted + 0.6 * y * y) / 140.0;
    z += 22.0 * exp(-(x * x + 0.4 * (y - 6.0) * (y - 6.0)) / 200.0) - x * sin(p->yaw_rad);
    for (int k = 0; k < 10; k++) {
        double u = sim_random_between(&shape, -60.0, 60.0);
        double v = sim_random_between(&shape, -60.0, 60.0), h = 2.5 * sim_random_normal(&shape);
        z += h * exp(-((x - u) * (x - u) + (y - v) * (y - v)) / 400.0);
    }
    return z + (p->noise_mm > 0.0 ? p->noise_mm * sim_random_normal(p->random) : 0.0);
}

/* Skin with spots of a person's own, `tone` times as bright. */
static void paint(struct sim_scan *scan, uint64_t key, double tone)
{
    if (!scan->reflectance) {
        scan->reflectance = calloc(sim_scan_pixels(scan), sizeof *scan->reflectance);
        assert_non_null(scan->reflectance);
    }
    for (int i = 0; i < SIDE * SIDE; i++) {
        struct iso_vec3 p = sim_scan_point(scan, i % SIDE, i / SIDE);
        scan->reflectance[i] = (float)(tone * (1.0 + 0.6 * sin(0.1 * p.x + (double)key) *
                                                         sin(0.12 * p.y + 2.0 * (double)key)));
    }
}

static const double places[ISO_LANDMARKS][2] = {
    {0, 32},  {0, 0},    {0, -12}, {-15, -6}, {15, -6},   {-16, 30},
    {16, 30}, {-44, 32}, {44, 32}, {0, -22},  {-24, -30}, {24, -30},
};

/* Landmarks are where a person has them: up to a few mm away, less what finding them is wrong. */
static struct sim_scan *draw_person(uint64_t key, double noise_mm, uint64_t take)
{
    struct sim_random random = sim_random_seeded(8, key, take);
    struct sim_random own = sim_random_seeded(9, key, 0);
    struct person person = {key, noise_mm, 0.0, &random};
    struct sim_scan *scan = draw(relief, &person);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        double x = places[l][0] + 2.5 * sim_random_normal(&own);
        double y = places[l][1] + 2.5 * sim_random_normal(&own), z = 0.0;
        x += noise_mm * sim_random_normal(&random);
        y += noise_mm * sim_random_normal(&random);
        assert_true(sim_scan_height(scan, x, y, &z, NULL));
        scan->source_mm[l] = scan->landmark_mm[l] = iso_vec3(x, y, z);
        int mark = sim_mark_find(iso_landmark_name((enum iso_landmark)l));
        assert_true(mark >= 0);
        scan->mark_known[mark] = true;
        scan->mark_mm[mark] = scan->landmark_mm[l];
    }
    paint(scan, key, 1.0);
    return scan;
}

enum { LEARNED = 20, TAKES = 2 };

struct lesson {
    struct sim_scan *scans[LEARNED * TAKES];
    uint32_t person[LEARNED * TAKES];
    bool marks[SIM_MARKS];
};

static int setup(void **state)
{
    struct lesson *lesson = calloc(1, sizeof *lesson);
    for (uint32_t i = 0; i < LEARNED * TAKES; i++) {
        lesson->person[i] = i / TAKES;
        lesson->scans[i] = draw_person(1000 + i / TAKES, 0.3, i % TAKES);
    }
    memcpy(lesson->marks, lesson->scans[0]->mark_known, sizeof lesson->marks);
    *state = lesson;
    return 0;
}

static int teardown(void **state)
{
    struct lesson *lesson = *state;
    for (int i = 0; i < LEARNED * TAKES; i++) {
        sim_scan_free(lesson->scans[i]);
    }
    free(lesson);
    return 0;
}

static struct sim_training training_of(const struct lesson *lesson)
{
    return (struct sim_training){.n = LEARNED * TAKES,
                                 .faces = (const struct sim_scan *const *)lesson->scans,
                                 .person = lesson->person,
                                 .n_people = LEARNED,
                                 .marks = lesson->marks};
}

static void *learn(const struct sim_method *method, const struct lesson *lesson)
{
    struct sim_training training = training_of(lesson);
    struct iso_fault fault = {.text = ""};
    void *knowledge = NULL;
    if (method->train && method->train(&training, &knowledge, &fault)) {
        fail_msg("%s", fault.text);
    }
    return knowledge;
}

static void *describe(const struct sim_method *method, const void *knowledge,
                      const struct sim_scan *scan)
{
    void *description = NULL;
    assert_int_equal(method->describe(knowledge, scan, &description), 0);
    return description;
}

static double distance(const struct sim_method *method, const void *knowledge, const void *probe,
                       const void *gallery)
{
    double d = NAN;
    assert_int_equal(method->distance(knowledge, probe, gallery, &d), 0);
    assert_true(d >= -1e-6);
    return d;
}

/* Five people nobody learned from: each is nearest to his or her own other take; by CP-HK, which
 * knows tips and proportions and little else, more of them than by chance. */
static void test_methods_tell_people_apart(void **state)
{
    enum { PEOPLE = 5 };
    for (size_t m = 0; sim_methods[m]; m++) {
        const struct sim_method *method = sim_methods[m];
        if (!sim_method_pairwise(method)) {
            continue;
        }
        void *knowledge = learn(method, *state), *enrolled[PEOPLE];
        int mistaken = 0;
        struct sim_scan *scans[PEOPLE];
        for (uint64_t p = 0; p < PEOPLE; p++) {
            scans[p] = draw_person(p, 0.2, 0);
            enrolled[p] = describe(method, knowledge, scans[p]);
        }
        for (uint64_t p = 0; p < PEOPLE; p++) {
            struct sim_scan *scan = draw_person(p, 0.2, 1);
            void *probe = describe(method, knowledge, scan);
            double own = distance(method, knowledge, probe, enrolled[p]), other = INFINITY;
            for (uint64_t q = 0; q < PEOPLE; q++) {
                double d = distance(method, knowledge, probe, enrolled[q]);
                other = q == p ? other : fmin(other, d);
            }
            mistaken += other <= own;
            method->discard(probe);
            sim_scan_free(scan);
        }
        print_message("%s: %d of %d are taken for another\n", method->name, mistaken, PEOPLE);
        assert_true(mistaken <= (method == &sim_method_cp_hk ? 2 : 0));
        for (int p = 0; p < PEOPLE; p++) {
            method->discard(enrolled[p]);
            sim_scan_free(scans[p]);
        }
        if (method->forget) {
            method->forget(knowledge);
        }
    }
}

static void test_table(void **state)
{
    (void)state;
    assert_ptr_equal(sim_methods[0], &sim_method_hfpc);
    assert_false(sim_method_pairwise(&sim_method_hfpc));
    size_t n = 0;
    for (; sim_methods[n]; n++) {
        assert_ptr_equal(sim_method_find(sim_methods[n]->name), sim_methods[n]);
        assert_true(strlen(sim_methods[n]->source) > 20);
        assert_true((sim_methods[n]->train == NULL) == (sim_methods[n]->forget == NULL));
    }
    assert_int_equal(n, SIM_METHODS);
    assert_null(sim_method_find("eigenfaces"));
}

static double icp_between(const struct sim_method *icp, const struct sim_scan *a,
                          const struct sim_scan *b)
{
    void *probe = describe(icp, NULL, a), *gallery = describe(icp, NULL, b);
    double d = distance(icp, NULL, probe, gallery);
    icp->discard(probe);
    icp->discard(gallery);
    return d;
}

/* The same person, head turned a little against the frame: what is left is the turn's own change of
 * shape, far less than another person. */
static void test_icp_moves_faces(void **state)
{
    (void)state;
    struct person straight = {3, 0.0, 0.0, NULL}, turned = {3, 0.0, 0.06, NULL},
                  other = {4, 0.0, 0.0, NULL};
    struct sim_scan *a = draw(relief, &straight), *b = draw(relief, &turned),
                    *c = draw(relief, &other);
    double same = icp_between(&sim_method_icp, a, a);
    double moved = icp_between(&sim_method_icp, a, b), else_where = 0.0;
    for (size_t i = 0; i < sim_scan_pixels(a); i++) {
        double d = (double)(a->z_mm[i] - b->z_mm[i]);
        else_where = isnan(d) ? else_where : fmax(else_where, fabs(d));
    }
    assert_true(same < 1e-4);
    assert_true(else_where > 4.0); /* before they are registered */
    assert_true(moved < 0.2);
    assert_true(icp_between(&sim_method_icp, a, c) > 2.0 * moved);
    sim_scan_free(a);
    sim_scan_free(b);
    sim_scan_free(c);
}

/* What changes below the nose does not reach the upper face's ICP. */
static void test_icp_upper_looks_above(void **state)
{
    (void)state;
    struct sim_scan *a = draw_person(5, 0.0, 0), *b = draw_person(5, 0.0, 0);
    for (int row = SIDE / 2 + 8; row < SIDE; row++) {
        for (int column = 0; column < SIDE; column++) {
            b->z_mm[row * SIDE + column] += (float)(3.0 * sin(0.4 * row));
        }
    }
    assert_true(icp_between(&sim_method_icp_upper, a, b) < 0.02);
    assert_true(icp_between(&sim_method_icp, a, b) > 0.1);
    sim_scan_free(a);
    sim_scan_free(b);
}

static void test_icp_wants_overlap(void **state)
{
    (void)state;
    struct sim_scan *a = draw_person(5, 0.0, 0), *b = draw_person(5, 0.0, 0);
    for (int i = 0; i < SIDE * SIDE; i++) { /* the left halves; the right ones */
        a->measured[i] = a->measured[i] && i % SIDE < SIDE / 2 - 4;
        b->measured[i] = b->measured[i] && i % SIDE > SIDE / 2 + 4;
    }
    void *probe = describe(&sim_method_icp, NULL, a), *gallery = describe(&sim_method_icp, NULL, b);
    double d = -1.0;
    assert_int_equal(sim_method_icp.distance(NULL, probe, gallery, &d), -ENODATA);
    assert_float_equal(d, -1.0, 0.0);
    sim_method_icp.discard(probe);
    sim_method_icp.discard(gallery);
    memset(a->measured, 0, sim_scan_pixels(a));
    void *nothing = NULL;
    assert_int_equal(sim_method_icp.describe(NULL, a, &nothing), -ENODATA);
    assert_null(nothing);
    sim_scan_free(a);
    sim_scan_free(b);
}

static double weighted_between(const struct sim_scan *a, const struct sim_scan *b)
{
    return icp_between(&sim_method_hfpc_weighted, a, b);
}

/* Contours of heat on a weighted surface: skin that is as bright everywhere weighs nothing, its
 * pattern does, and without an image there is nothing to describe. */
static void test_skin_bends_contours(void **state)
{
    (void)state;
    struct sim_scan *plain = draw_person(5, 0.0, 0), *bright = draw_person(5, 0.0, 0),
                    *spotted = draw_person(5, 0.0, 0), *blind = draw_person(5, 0.0, 0);
    for (int i = 0; i < SIDE * SIDE; i++) {
        plain->reflectance[i] = 1.0f;
        bright->reflectance[i] = 2.5f;
    }
    double evenly = weighted_between(plain, bright), bent = weighted_between(plain, spotted);
    paint(bright, 5, 2.5);
    double scaled = weighted_between(spotted, bright);
    print_message("evenly brighter %.4f mm, spotted %.4f mm, spotted and brighter %.4f mm\n",
                  evenly, bent, scaled);
    assert_true(evenly < 1e-3 && scaled < 1e-3);
    assert_true(bent > 0.1);
    free(blind->reflectance);
    blind->reflectance = NULL;
    void *description = NULL;
    assert_int_equal(sim_method_hfpc_weighted.describe(NULL, blind, &description), -ENODATA);
    assert_null(description);
    sim_scan_free(plain);
    sim_scan_free(bright);
    sim_scan_free(spotted);
    sim_scan_free(blind);
}

/* The control sees no image, and is what the weighted method makes of skin that has no pattern. */
static void test_control_weighs_nothing(void **state)
{
    (void)state;
    const struct sim_method *control = &sim_method_hfpc_weighted_1,
                            *weighted = &sim_method_hfpc_weighted;
    struct sim_scan *plain = draw_person(5, 0.0, 0), *spotted = draw_person(5, 0.0, 0);
    for (int i = 0; i < SIDE * SIDE; i++) {
        plain->reflectance[i] = 1.0f;
    }
    void *weightless = describe(weighted, NULL, plain),
         *controlled = describe(control, NULL, spotted);
    assert_float_equal(distance(control, NULL, controlled, weightless), 0.0, 0.0);
    control->discard(controlled);
    free(spotted->reflectance);
    spotted->reflectance = NULL;
    controlled = describe(control, NULL, spotted);
    assert_float_equal(distance(control, NULL, controlled, weightless), 0.0, 0.0);
    control->discard(controlled);
    weighted->discard(weightless);
    sim_scan_free(plain);
    sim_scan_free(spotted);
}

static double plane(const void *context, double x, double y)
{
    (void)y;
    return *(const double *)context * x;
}

/* A cylinder about the y axis: unrolled it is a plane. */
static double cylinder(const void *context, double x, double y)
{
    (void)y;
    double r = *(const double *)context;
    return sqrt(r * r - x * x) - r;
}

static double geodesic(const struct sim_scan *scan, struct iso_vec3 from, struct iso_vec3 to)
{
    struct sim_geodesic *g = NULL;
    double d = NAN;
    assert_int_equal(sim_geodesic_new(scan, &g), 0);
    assert_int_equal(sim_geodesic_from(g, scan, from, &to, 1, &d), 0);
    sim_geodesic_free(g);
    return d;
}

static void test_geodesics(void **state)
{
    (void)state;
    double slope = 0.75, r = 100.0;
    struct sim_scan *tilted = draw(plane, &slope), *round = draw(cylinder, &r);
    struct sim_random random = sim_random_seeded(4, 4, 4);
    for (int i = 0; i < 12; i++) {
        struct iso_vec3 a = {sim_random_between(&random, -50.0, 50.0),
                             sim_random_between(&random, -50.0, 50.0), 0.0};
        struct iso_vec3 b = {sim_random_between(&random, -50.0, 50.0),
                             sim_random_between(&random, -50.0, 50.0), 0.0};
        double flat = hypot(1.25 * (a.x - b.x), a.y - b.y);
        double bent = hypot(r * (asin(a.x / r) - asin(b.x / r)), a.y - b.y);
        double tilted_mm = geodesic(tilted, a, b), bent_mm = geodesic(round, a, b);
        /* 1.4 % in a plane seen straight; a tilted one stretches the steps' directions apart. */
        assert_true(tilted_mm > flat - 1e-6 && tilted_mm < 1.02 * flat + 0.6 * spacing_mm);
        assert_true(bent_mm > 0.998 * bent && bent_mm < 1.02 * bent + 0.6 * spacing_mm);
    }
    struct sim_geodesic *g = NULL;
    struct iso_vec3 inside = {0.0, 0.0, 0.0}, outside = {89.0, 89.0, 0.0};
    double d = -1.0;
    assert_int_equal(sim_geodesic_new(round, &g), 0);
    assert_int_equal(sim_geodesic_from(g, round, inside, &outside, 1, &d), -ENODATA);
    assert_int_equal(sim_geodesic_from(g, round, outside, &inside, 1, &d), -ENODATA);
    assert_float_equal(d, -1.0, 0.0);
    sim_geodesic_free(g);
    sim_scan_free(tilted);
    sim_scan_free(round);
}

static void test_contours_need_a_surface(void **state)
{
    (void)state;
    struct sim_scan *scan = draw_person(5, 0.0, 0);
    void *description = NULL;
    scan->source_mm[3] = iso_vec3(89.0, 89.0, 0.0);
    assert_int_equal(sim_method_hfpc_literal.describe(NULL, scan, &description), -ENODATA);
    assert_null(description);
    sim_scan_free(scan);
}

static void expect_untaught(const struct sim_method *method, const struct sim_training *training,
                            const char *words)
{
    struct iso_fault fault = {.text = ""};
    void *knowledge = NULL;
    assert_int_equal(method->train(training, &knowledge, &fault), -EINVAL);
    assert_null(knowledge);
    if (!strstr(fault.text, words)) {
        fail_msg("'%s' does not say '%s'", fault.text, words);
    }
}

static void test_refuses_to_learn(void **state)
{
    struct sim_training training = training_of(*state);
    const uint32_t alone[LEARNED * TAKES] = {0};
    training.person = alone;
    training.n_people = 1;
    expect_untaught(&sim_method_fishersurfaces, &training, "fishersurfaces: 40 faces of 1 person");
    expect_untaught(&sim_method_anthroface_10, &training, "anthroface-10: 40 faces of 1 person");
    training = training_of(*state);
    const bool marks[SIM_MARKS] = {true, true};
    training.marks = marks;
    expect_untaught(&sim_method_anthroface_25, &training, "2 points are marked");
    training.n = 1;
    expect_untaught(&sim_method_eigensurfaces, &training, "eigensurfaces: 1 faces");
}

static void test_marks_are_needed(void **state)
{
    void *knowledge = learn(&sim_method_anthroface_25, *state), *description = NULL;
    struct sim_scan *scan = draw_person(5, 0.0, 0);
    scan->mark_known[sim_mark_find("nose_tip")] = false;
    assert_int_equal(sim_method_anthroface_25.describe(knowledge, scan, &description), -ENODATA);
    sim_scan_free(scan);
    sim_method_anthroface_25.forget(knowledge);
    assert_int_equal(sim_mark_find("ear"), -1);
}

static void test_fusing(void **state)
{
    (void)state;
    struct sim_scan *a = draw_person(5, 0.0, 0), *b = draw_person(5, 0.0, 0), *fused = NULL;
    const struct sim_scan *both[] = {a, b};
    a->reflectance[SIDE * 30 + 40] = 0.5f;
    b->reflectance[SIDE * 30 + 40] = 1.5f;
    a->z_mm[SIDE * 30 + 40] = 10.0f;
    b->z_mm[SIDE * 30 + 40] = 14.0f;
    a->z_mm[SIDE * 30 + 41] = 10.0f;
    b->z_mm[SIDE * 30 + 41] = 14.0f;
    b->measured[SIDE * 30 + 41] = 0; /* filled in: only the other counts */
    b->mark_known[0] = false;
    a->mark_known[0] = true;
    a->mark_mm[0] = iso_vec3(3.0, 5.0, 7.0);
    a->landmark_mm[2] = iso_vec3(2.0, 4.0, 6.0);
    b->landmark_mm[2] = iso_vec3(4.0, 8.0, 0.0);
    assert_int_equal(sim_scan_fuse(both, 2, &fused), 0);
    assert_float_equal(fused->z_mm[SIDE * 30 + 40], 12.0f, 1e-6);
    assert_float_equal(fused->z_mm[SIDE * 30 + 41], 10.0f, 1e-6);
    assert_int_equal(fused->measured[SIDE * 30 + 41], 1);
    assert_float_equal(fused->reflectance[SIDE * 30 + 40], 1.0f, 1e-6);
    assert_true(isnan(fused->z_mm[0]));
    assert_float_equal(fused->mark_mm[0].y, 5.0, 1e-9);
    assert_float_equal(fused->landmark_mm[2].y, 6.0, 1e-9);
    sim_scan_free(fused);
    fused = NULL;
    assert_int_equal(sim_scan_fuse(both, 0, &fused), -EINVAL);
    b->spacing_mm = 2.0;
    assert_int_equal(sim_scan_fuse(both, 2, &fused), -EINVAL);
    assert_null(fused);
    assert_int_equal(sim_scan_new(60, 2.0, &fused), -EINVAL);
    assert_int_equal(sim_scan_new(61, 0.0, &fused), -EINVAL);
    sim_scan_free(a);
    sim_scan_free(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table),
        cmocka_unit_test_setup_teardown(test_methods_tell_people_apart, setup, teardown),
        cmocka_unit_test(test_icp_moves_faces),
        cmocka_unit_test(test_icp_upper_looks_above),
        cmocka_unit_test(test_icp_wants_overlap),
        cmocka_unit_test(test_skin_bends_contours),
        cmocka_unit_test(test_control_weighs_nothing),
        cmocka_unit_test(test_geodesics),
        cmocka_unit_test(test_contours_need_a_surface),
        cmocka_unit_test_setup_teardown(test_refuses_to_learn, setup, teardown),
        cmocka_unit_test_setup_teardown(test_marks_are_needed, setup, teardown),
        cmocka_unit_test(test_fusing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
