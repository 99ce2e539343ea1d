/* The skin of rendered heads in infrared images. The test needs the head model's data
 * (ISOTHERM_SHARED/data/ict-face). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/world/face/skin.h"
#include "sim/world/scene/portrait.h"
#include "tests/support/scratch.h"
#include "tests/support/shared_data.h"

static struct sim_ict *load(void)
{
    const char *path = shared_data_or_skip("data/ict-face");
    struct sim_ict *ict = NULL;
    assert_int_equal(sim_ict_load(path, &ict, NULL), 0);
    return ict;
}

static float *albedo_of(const struct sim_ict *ict, uint32_t index)
{
    struct sim_person person = sim_person_draw(SIM_POPULATION_TEST, 4, index, 1.0);
    float *albedo = malloc(ict->n_triangles * sizeof *albedo);
    assert_non_null(albedo);
    assert_int_equal(sim_skin_albedo(ict, &person, albedo), 0);
    return albedo;
}

/* Returns the mean over the triangles at a vertex. */
static double at_vertex(const struct sim_ict *ict, const float *albedo, uint32_t vertex)
{
    double sum = 0.0;
    int n = 0;
    for (uint32_t t = 0; t < ict->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            if (ict->triangles[t][k] == vertex) {
                sum += (double)albedo[t];
                n++;
            }
        }
    }
    assert_true(n > 0);
    return sum / n;
}

static void parts_of_the_face_differ(void **state)
{
    struct sim_ict *ict = load();
    (void)state;
    for (uint32_t person = 0; person < 5; person++) {
        float *albedo = albedo_of(ict, person);
        float least = 1.0F, most = 0.0F;
        for (uint32_t t = 0; t < ict->n_triangles; t++) {
            least = albedo[t] < least ? albedo[t] : least;
            most = albedo[t] > most ? albedo[t] : most;
        }
        double nose = at_vertex(ict, albedo, ict->landmarks[30]);
        double lip = at_vertex(ict, albedo, ict->landmarks[51]);
        double corner = at_vertex(ict, albedo, ict->landmarks[36]);
        assert_true(nose >= 0.5 && nose <= 0.65);
        assert_true(lip < 0.95 * nose && lip > 0.6 * nose);
        assert_true(corner < 0.75 * nose); /* eyelashes, and the eyeball beside them */
        assert_true((double)least < 0.05); /* pupils */
        assert_true((double)most <= 0.65);
        free(albedo);
    }
    sim_ict_free(ict);
}

static void people_differ_and_stay_the_same(void **state)
{
    struct sim_ict *ict = load();
    float *one = albedo_of(ict, 1), *again = albedo_of(ict, 1), *other = albedo_of(ict, 2);
    (void)state;
    assert_memory_equal(one, again, ict->n_triangles * sizeof *one);
    assert_true(memcmp(one, other, ict->n_triangles * sizeof *one) != 0);
    free(one);
    free(again);
    free(other);
    sim_ict_free(ict);
}

/* Returns the mean of a box of a portrait. The box is given in pixels from the centre, down and to
 * the right. */
static double box(const float *portrait, int right, int down, int half_width, int half_height)
{
    double sum = 0.0;
    int n = 0;
    for (int r = down - half_height; r <= down + half_height; r++) {
        for (int c = right - half_width; c <= right + half_width; c++, n++) {
            sum += (double)portrait[(SIM_PORTRAIT_ROWS / 2 + r) * SIM_PORTRAIT_COLUMNS +
                                    SIM_PORTRAIT_COLUMNS / 2 + c];
        }
    }
    return sum / n;
}

static void a_portrait_shows_a_face(void **state)
{
    struct sim_ict *ict = load();
    struct sim_person person = sim_person_mean();
    struct sim_sitter_options options = {.hair = false};
    struct sim_random random = sim_random_seeded(1, 0, 0);
    struct sim_sitter *sitter;
    float *portrait = malloc(SIM_PORTRAIT_COLUMNS * SIM_PORTRAIT_ROWS * sizeof *portrait);
    (void)state;
    assert_non_null(portrait);
    assert_int_equal(sim_sitter_new(ict, &person, &options, &random, &sitter), 0);
    assert_int_equal(sim_portrait(sitter, portrait), 0);
    /* The eyes of the mean face are 31 mm beside and 38 mm above its nose tip (10 down). The cheeks
     * are below them. */
    double eye_r = box(portrait, -31, -28, 8, 3), eye_l = box(portrait, 31, -28, 8, 3);
    double cheek_r = box(portrait, -35, 5, 8, 5), cheek_l = box(portrait, 35, 5, 8, 5);
    print_message("eyes %.2f %.2f, cheeks %.2f %.2f, nose %.2f\n", eye_r, eye_l, cheek_r, cheek_l,
                  box(portrait, 0, 8, 3, 3));
    assert_true(eye_r < 0.85 * cheek_r && eye_l < 0.85 * cheek_l);
    assert_true(box(portrait, 0, 8, 3, 3) > eye_r);     /* the tip faces the camera */
    assert_true(box(portrait, -90, -125, 2, 2) < 0.06); /* the corner of the paper */
    free(portrait);
    sim_sitter_free(sitter);
    sim_ict_free(ict);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_of_the_face_differ),
        cmocka_unit_test(people_differ_and_stay_the_same),
        cmocka_unit_test(a_portrait_shows_a_face),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
