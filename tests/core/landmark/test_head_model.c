/* A head model. The reader returns what was written, the writer refuses a model that could not be
 * read, and the points of a model follow its shape. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/base/bytes.h"
#include "core/base/crc32.h"
#include "tests/core/landmark/small_head_model.h"
#include "tests/support/memory/scarce_memory.h"
#include "tests/support/near.h"

static void a_model_survives_its_bytes(void **state)
{
    (void)state;
    struct iso_head_model *model = small_head_model(), *back = NULL;
    uint8_t *file = small_head_model_file();
    assert_int_equal(iso_head_model_parse(file, SIZE, &back, NULL), 0);
    assert_int_equal(back->n_vertices, N_VERTICES);
    assert_int_equal(back->n_triangles, N_TRIANGLES);
    assert_int_equal(back->n_identity, N_IDENTITY);
    assert_int_equal(back->n_expression, N_EXPRESSION);
    assert_int_equal(back->crc32, iso_crc32(0, file + AT_COUNTS, SIZE - AT_COUNTS));
    assert_memory_equal(back->mean_mm, model->mean_mm, N_VERTICES * sizeof *model->mean_mm);
    assert_memory_equal(back->triangles, model->triangles, N_TRIANGLES * sizeof *model->triangles);
    assert_memory_equal(back->region, model->region, N_VERTICES);
    assert_memory_equal(back->landmarks, model->landmarks, sizeof model->landmarks);
    for (int i = 0; i < N_IDENTITY * N_VERTICES * 3; i++) {
        assert_near((double)back->identity_mm[i], (double)model->identity_mm[i],
                    1.5 / 32767.0 + 1e-6);
    }
    for (int i = 0; i < N_EXPRESSION * N_VERTICES * 3; i++) {
        assert_near((double)back->expression_mm[i], (double)model->expression_mm[i],
                    1.0 / 32767.0 + 1e-6);
    }
    iso_head_model_free(back);
    iso_head_model_free(model);
    free(file);
}

/* Reads the file by hand, as the header describes it. */
static void the_file_is_laid_out_as_documented(void **state)
{
    (void)state;
    uint8_t *file = small_head_model_file();
    assert_memory_equal(file, "ISOHEAD1", 8);
    assert_int_equal(iso_get_u32(file + AT_SIZE), SIZE);
    assert_int_equal(iso_get_u32(file + AT_COUNTS), N_VERTICES);
    assert_int_equal(iso_get_u32(file + AT_COUNTS + 4), N_TRIANGLES);
    assert_int_equal(iso_get_u32(file + AT_COUNTS + 8), N_IDENTITY);
    assert_int_equal(iso_get_u32(file + AT_COUNTS + 12), N_EXPRESSION);
    assert_true(iso_get_f32(file + AT_MEAN + 12 + 4) == 6.25f);    /* y of vertex 1 */
    assert_int_equal(iso_get_u16(file + AT_TRIANGLES + 6 + 4), 3); /* third corner of triangle 1 */
    assert_int_equal(file[AT_REGION + 3], ISO_HEAD_FACE | ISO_HEAD_RIGID);
    assert_int_equal(iso_get_u16(file + AT_LANDMARKS + 16), 1);
    assert_int_equal(iso_get_u16(file + AT_LANDMARKS + 16 + 2), 0);
    assert_true(iso_get_f32(file + AT_LANDMARKS + 16 + 4) == 0.01f);
    const uint8_t *expression = file + AT_MODES + N_IDENTITY * (4 + 6 * N_VERTICES);
    float scale = iso_get_f32(expression);
    assert_near((double)scale, 2.0 / 32767.0, 1e-9); /* the largest is 0.2 (14 - 4) */
    assert_int_equal((int16_t)iso_get_u16(expression + 4 + 2 * 14), 32767);
    assert_near((double)(scale * (float)(int16_t)iso_get_u16(expression + 4)), -0.8, 1e-4);
    free(file);
}

static void a_mode_of_zeros_stays_so(void **state)
{
    (void)state;
    struct iso_head_model *model = small_head_model(), *back = NULL;
    memset(model->expression_mm, 0, 3 * N_VERTICES * sizeof *model->expression_mm);
    void *bytes = NULL;
    size_t size;
    assert_int_equal(iso_head_model_serialise(model, &bytes, &size), 0);
    assert_int_equal(iso_head_model_parse(bytes, size, &back, NULL), 0);
    for (int i = 0; i < 3 * N_VERTICES; i++) {
        assert_true(back->expression_mm[i] == 0.0f);
    }
    iso_head_model_free(back);
    iso_head_model_free(model);
    free(bytes);
}

static void does_not_write_what_it_would_not_read(void **state)
{
    (void)state;
    for (int i = 0; i < 7; i++) {
        struct iso_head_model *model = small_head_model();
        uint32_t n_vertices = model->n_vertices;
        switch (i) {
        case 0:
            model->n_vertices = 2;
            break;
        case 1:
            model->mean_mm[4].y = 1e300; /* finite, but not as a float */
            break;
        case 2:
            model->identity_mm[7] = NAN;
            break;
        case 3:
            model->expression_mm[14] = -INFINITY;
            break;
        case 4:
            model->triangles[2][1] = N_VERTICES;
            break;
        case 5:
            model->landmarks[67].weight[0] = -0.5f;
            break;
        default:
            model->region[4] = 0x80;
            break;
        }
        void *bytes = NULL;
        size_t size = 123;
        assert_int_equal(iso_head_model_serialise(model, &bytes, &size), -EINVAL);
        assert_null(bytes);
        assert_int_equal(size, 123);
        model->n_vertices = n_vertices;
        iso_head_model_free(model);
    }
}

static void does_not_write_too_large_a_file(void **state)
{
    (void)state;
    struct iso_head_model *model = NULL;
    assert_int_equal(iso_head_model_new(ISO_HEAD_VERTICES_MAX, 1, ISO_HEAD_IDENTITY_MAX, 0, &model),
                     0);
    for (uint32_t k = 0; k < 3; k++) {
        model->triangles[0][k] = k;
    }
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        model->landmarks[i].weight[0] = 1.0f;
    }
    void *bytes = NULL;
    size_t size = 123;
    assert_int_equal(iso_head_model_serialise(model, &bytes, &size), -EFBIG);
    assert_null(bytes);
    assert_int_equal(size, 123);
    iso_head_model_free(model);
}

static void refuses_to_make_a_model_out_of_range(void **state)
{
    (void)state;
    struct iso_head_model *model = NULL;
    assert_int_equal(iso_head_model_new(2, 1, 0, 0, &model), -EINVAL);
    assert_int_equal(iso_head_model_new(ISO_HEAD_VERTICES_MAX + 1, 1, 0, 0, &model), -EINVAL);
    assert_int_equal(iso_head_model_new(3, 0, 0, 0, &model), -EINVAL);
    assert_int_equal(iso_head_model_new(3, ISO_HEAD_TRIANGLES_MAX + 1, 0, 0, &model), -EINVAL);
    assert_int_equal(iso_head_model_new(3, 1, ISO_HEAD_IDENTITY_MAX + 1, 0, &model), -EINVAL);
    assert_int_equal(iso_head_model_new(3, 1, 0, ISO_HEAD_EXPRESSION_MAX + 1, &model), -EINVAL);
    assert_null(model);
    iso_head_model_free(NULL);
}

static void survives_any_failed_allocation(void **state)
{
    (void)state;
    struct iso_head_model *model = NULL, *whole = small_head_model();
    uint8_t *file = small_head_model_file();
    void *bytes = NULL;
    size_t size = 123;
    int n_failed = 0;
    for (bool failed = true; failed; n_failed += failed) {
        scarce_memory_left = n_failed;
        int error = iso_head_model_parse(file, SIZE, &model, NULL);
        failed = scarce_memory_left < 0;
        scarce_memory_left = -1;
        assert_int_equal(error, failed ? -ENOMEM : 0);
        assert_true(failed == (model == NULL));
    }
    assert_true(n_failed >= 5);
    scarce_memory_left = 0;
    int error = iso_head_model_serialise(whole, &bytes, &size);
    scarce_memory_left = -1;
    assert_int_equal(error, -ENOMEM);
    assert_null(bytes);
    assert_int_equal(size, 123);
    iso_head_model_free(whole);
    iso_head_model_free(model);
    free(file);
}

static void points_follow_the_shape(void **state)
{
    (void)state;
    struct iso_head_model *model = small_head_model();
    struct iso_vec3 shape[N_VERTICES] = {{0, 0, 0}, {8, 0, 0}, {0, 16, 0}, {0, 0, 32}, {1, 1, 1}};
    struct iso_head_point point = {1, {0.25f, 0.5f, 0.25f}}; /* of vertices 2, 1, 3 */
    struct iso_vec3 p = iso_head_point_on(model, shape, point);
    assert_near(p.x, 4.0, 1e-12);
    assert_near(p.y, 4.0, 1e-12);
    assert_near(p.z, 8.0, 1e-12);
    p = iso_head_point_on(model, model->mean_mm, point);
    assert_near(p.x, 0.25 * 21.0 + 0.5 * 10.5 + 0.25 * 31.5, 1e-12);
    assert_near(p.y, 0.25 * 5.25 + 0.5 * 6.25 + 0.25 * 4.25, 1e-12);
    iso_head_model_free(model);
}

static struct iso_vec3 mean_landmark(const struct iso_head_model *model, enum iso_landmark landmark)
{
    return iso_head_point_on(model, model->mean_mm, model->landmarks[iso_landmark_ibug[landmark]]);
}

/* The model that ships with the product. */
static void the_shipped_model_is_sound(void **state)
{
    (void)state;
    FILE *stream = fopen(ISOTHERM_SOURCE_DIR "/core/data/head.model", "rb");
    assert_non_null(stream);
    uint8_t *bytes = malloc(ISO_HEAD_BYTES_MAX + 1);
    assert_non_null(bytes);
    size_t size = fread(bytes, 1, ISO_HEAD_BYTES_MAX + 1, stream);
    assert_int_equal(fclose(stream), 0);
    struct iso_head_model *model = NULL;
    assert_int_equal(iso_head_model_parse(bytes, size, &model, NULL), 0);
    struct iso_vec3 nose = mean_landmark(model, ISO_LM_NOSE_TIP);
    assert_int_equal(iso_landmark_ibug[ISO_LM_NOSE_TIP], 30);
    assert_true(iso_norm(nose) < 1e-6);
    /* x to the subject's left, y up, z out of the face. */
    struct iso_vec3 left = mean_landmark(model, ISO_LM_EYE_OUT_L);
    struct iso_vec3 right = mean_landmark(model, ISO_LM_EYE_OUT_R);
    struct iso_vec3 lip = mean_landmark(model, ISO_LM_LIP_UPPER);
    assert_true(left.x > 30.0 && right.x < -30.0 && left.y > 15.0 && left.z < -15.0);
    assert_true(lip.y < -15.0);
    iso_head_model_free(model);
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_model_survives_its_bytes),
        cmocka_unit_test(the_file_is_laid_out_as_documented),
        cmocka_unit_test(a_mode_of_zeros_stays_so),
        cmocka_unit_test(does_not_write_what_it_would_not_read),
        cmocka_unit_test(does_not_write_too_large_a_file),
        cmocka_unit_test(refuses_to_make_a_model_out_of_range),
        cmocka_unit_test(survives_any_failed_allocation),
        cmocka_unit_test(points_follow_the_shape),
        cmocka_unit_test(the_shipped_model_is_sound),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
