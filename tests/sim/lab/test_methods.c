/* Every method on faces with known shape: smooth hills that differ from person to person. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/lab/methods/anthroface.h"
#include "sim/lab/methods/method.h"
#include "tests/sim/lab/drawn_face.h"

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
        lesson->scans[i] = drawn_face(1000 + i / TAKES, 0.3, i % TAKES);
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

/* Five people from whom no method learned. Each take is nearest to the other take of the same
 * person. CP-HK knows little except tips and proportions; for it the test requires more hits than
 * by chance. */
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
            scans[p] = drawn_face(p, 0.2, 0);
            enrolled[p] = described(method, knowledge, scans[p]);
        }
        for (uint64_t p = 0; p < PEOPLE; p++) {
            struct sim_scan *scan = drawn_face(p, 0.2, 1);
            void *probe = described(method, knowledge, scan);
            double own = method_distance(method, knowledge, probe, enrolled[p]), other = INFINITY;
            for (uint64_t q = 0; q < PEOPLE; q++) {
                double d = method_distance(method, knowledge, probe, enrolled[q]);
                other = q == p ? other : fmin(other, d);
            }
            mistaken += other <= own;
            method->discard(probe);
            sim_scan_free(scan);
        }
        print_message("%s: %d of %d people mistaken\n", method->name, mistaken, PEOPLE);
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
    struct sim_scan *scan = drawn_face(5, 0.0, 0);
    scan->mark_known[sim_mark_find("nose_tip")] = false;
    assert_int_equal(sim_method_anthroface_25.describe(knowledge, scan, &description), -ENODATA);
    sim_scan_free(scan);
    sim_method_anthroface_25.forget(knowledge);
    assert_int_equal(sim_mark_find("ear"), -1);
}

static void test_fusing(void **state)
{
    (void)state;
    struct sim_scan *a = drawn_face(5, 0.0, 0), *b = drawn_face(5, 0.0, 0), *fused = NULL;
    const struct sim_scan *both[] = {a, b};
    a->reflectance[DRAWN_SIDE * 30 + 40] = 0.5f;
    b->reflectance[DRAWN_SIDE * 30 + 40] = 1.5f;
    a->z_mm[DRAWN_SIDE * 30 + 40] = 10.0f;
    b->z_mm[DRAWN_SIDE * 30 + 40] = 14.0f;
    a->z_mm[DRAWN_SIDE * 30 + 41] = 10.0f;
    b->z_mm[DRAWN_SIDE * 30 + 41] = 14.0f;
    b->measured[DRAWN_SIDE * 30 + 41] = 0; /* filled in: only the other surface counts */
    b->mark_known[0] = false;
    a->mark_known[0] = true;
    a->mark_mm[0] = iso_vec3(3.0, 5.0, 7.0);
    a->landmark_mm[2] = iso_vec3(2.0, 4.0, 6.0);
    b->landmark_mm[2] = iso_vec3(4.0, 8.0, 0.0);
    assert_int_equal(sim_scan_fuse(both, 2, &fused), 0);
    assert_float_equal(fused->z_mm[DRAWN_SIDE * 30 + 40], 12.0f, 1e-6);
    assert_float_equal(fused->z_mm[DRAWN_SIDE * 30 + 41], 10.0f, 1e-6);
    assert_int_equal(fused->measured[DRAWN_SIDE * 30 + 41], 1);
    assert_float_equal(fused->reflectance[DRAWN_SIDE * 30 + 40], 1.0f, 1e-6);
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
        cmocka_unit_test_setup_teardown(test_refuses_to_learn, setup, teardown),
        cmocka_unit_test_setup_teardown(test_marks_are_needed, setup, teardown),
        cmocka_unit_test(test_fusing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
