#include "tests/core/surfaces/shipped_model.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

struct iso_head_model *shipped_head_model(void)
{
    FILE *stream = fopen(ISOTHERM_SOURCE_DIR "/core/data/head.model", "rb");
    uint8_t *bytes = malloc(ISO_HEAD_BYTES_MAX + 1);
    assert_non_null(stream);
    assert_non_null(bytes);
    const size_t size = fread(bytes, 1, ISO_HEAD_BYTES_MAX + 1, stream);
    assert_int_equal(fclose(stream), 0);
    struct iso_head_model *model = NULL;
    assert_int_equal(iso_head_model_parse(bytes, size, &model, NULL), 0);
    free(bytes);
    return model;
}
