#include "tests/core/landmark/small_head_model.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "core/base/bytes.h"
#include "core/base/crc32.h"

struct iso_head_model *small_head_model(void)
{
    struct iso_head_model *model = NULL;
    assert_int_equal(iso_head_model_new(N_VERTICES, N_TRIANGLES, N_IDENTITY, N_EXPRESSION, &model),
                     0);
    static const uint32_t triangles[N_TRIANGLES][3] = {{0, 1, 2}, {2, 1, 3}, {4, 2, 3}};
    memcpy(model->triangles, triangles, sizeof triangles);
    for (int i = 0; i < N_VERTICES; i++) {
        model->mean_mm[i] = iso_vec3(10.5 * i, 7.25 - i, 0.5 * i * i);
        model->region[i] = (uint8_t)(i % 4);
    }
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        float a = 0.01f * (float)i, b = 0.25f;
        model->landmarks[i] = (struct iso_head_point){(uint32_t)i % N_TRIANGLES,
                                                      {a, b, 1.0f - a - b}};
    }
    for (int i = 0; i < N_IDENTITY * N_VERTICES * 3; i++) {
        model->identity_mm[i] = 3.0f * sinf(1.0f + (float)i);
    }
    for (int i = 0; i < N_EXPRESSION * N_VERTICES * 3; i++) {
        model->expression_mm[i] = 0.2f * (float)(i - 4);
    }
    return model;
}

uint8_t *small_head_model_file(void)
{
    struct iso_head_model *model = small_head_model();
    void *bytes = NULL;
    size_t size = 0;
    assert_int_equal(iso_head_model_serialise(model, &bytes, &size), 0);
    assert_int_equal(size, SIZE);
    iso_head_model_free(model);
    return bytes;
}

void small_head_model_seal(uint8_t *file, size_t size)
{
    (void)iso_put_u32(file + AT_CRC, iso_crc32(0, file + AT_COUNTS, size - AT_COUNTS));
}
