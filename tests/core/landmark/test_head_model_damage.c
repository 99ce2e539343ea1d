/* No damaged file is accepted as a head model. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/base/bytes.h"
#include "tests/core/landmark/small_head_model.h"

static void assert_refused(const uint8_t *file, size_t size, const char *why)
{
    struct iso_head_model *model = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_head_model_parse(file, size, &model, &fault), -EBADMSG);
    assert_null(model);
    assert_true(fault.text[0] != '\0');
    assert_non_null(strstr(fault.text, why));
}

static void refuses_every_truncation(void **state)
{
    (void)state;
    uint8_t *file = small_head_model_file();
    for (size_t size = 0; size < SIZE; size++) {
        /* A copy of exactly this size, so that the sanitizers find a read beyond it. */
        uint8_t *part = malloc(size + 1);
        assert_non_null(part);
        memcpy(part, file, size);
        part = realloc(part, size ? size : 1);
        assert_refused(part, size, "");
        if (size > AT_MEAN) { /* and a file that claims to be complete */
            (void)iso_put_u32(part + AT_SIZE, (uint32_t)size);
            small_head_model_seal(part, size);
            assert_refused(part, size, "size does not fit the counts");
        }
        free(part);
    }
    free(file);
}

static void refuses_bytes_after_the_end(void **state)
{
    (void)state;
    uint8_t *file = small_head_model_file(), longer[SIZE + 1] = {0};
    memcpy(longer, file, SIZE);
    assert_refused(longer, sizeof longer, "truncated or too long");
    (void)iso_put_u32(longer + AT_SIZE, sizeof longer);
    small_head_model_seal(longer, sizeof longer);
    assert_refused(longer, sizeof longer, "size does not fit the counts");
    free(file);
}

static void refuses_every_flipped_byte(void **state)
{
    (void)state;
    uint8_t *file = small_head_model_file();
    for (size_t i = 0; i < SIZE; i++) {
        file[i] ^= 0x40;
        assert_refused(file, SIZE, i < 7 ? "not a head model" : "head model: ");
        file[i] ^= 0x40;
    }
    struct iso_head_model *model = NULL;
    assert_int_equal(iso_head_model_parse(file, SIZE, &model, NULL), 0);
    iso_head_model_free(model);
    free(file);
}

static void refuses_another_version(void **state)
{
    (void)state;
    uint8_t *file = small_head_model_file();
    file[7] = '2';
    assert_refused(file, SIZE, "of another version");
    free(file);
}

static void refuses_more_than_the_largest_file(void **state)
{
    (void)state;
    size_t size = ISO_HEAD_BYTES_MAX + 1;
    uint8_t *file = small_head_model_file(), *large = calloc(1, size);
    assert_non_null(large);
    memcpy(large, file, SIZE);
    (void)iso_put_u32(large + AT_SIZE, (uint32_t)size);
    small_head_model_seal(large, size);
    assert_refused(large, size, "too long");
    free(large);
    free(file);
}

static void refuses_counts_out_of_range(void **state)
{
    (void)state;
    static const struct {
        int at;
        uint32_t value;
    } bad[] = {
        {0, 0},
        {0, 2},
        {0, ISO_HEAD_VERTICES_MAX + 1},
        {0, UINT32_MAX},
        {4, 0},
        {4, ISO_HEAD_TRIANGLES_MAX + 1},
        {4, UINT32_MAX},
        {8, ISO_HEAD_IDENTITY_MAX + 1},
        {8, UINT32_MAX},
        {12, ISO_HEAD_EXPRESSION_MAX + 1},
        {12, UINT32_MAX},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        uint8_t *file = small_head_model_file();
        (void)iso_put_u32(file + AT_COUNTS + bad[i].at, bad[i].value);
        small_head_model_seal(file, SIZE);
        assert_refused(file, SIZE, "a count is out of range");
        free(file);
    }
}

static void refuses_what_is_not_finite(void **state)
{
    (void)state;
    static const struct {
        int at;
        const char *why;
    } places[] = {
        {AT_MEAN + 12 * 3 + 8, "a vertex is not finite"},
        {AT_LANDMARKS + 16 * 7 + 8, "bad landmark"},
        {AT_MODES, "a mode is not finite"},
        {AT_MODES + N_IDENTITY * (4 + 6 * N_VERTICES), "a mode is not finite"},
    };
    static const float values[] = {NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < 3 * sizeof places / sizeof *places; i++) {
        uint8_t *file = small_head_model_file();
        (void)iso_put_f32(file + places[i / 3].at, values[i % 3]);
        small_head_model_seal(file, SIZE);
        assert_refused(file, SIZE, places[i / 3].why);
        free(file);
    }
}

static void refuses_inconsistent_contents(void **state)
{
    (void)state;
    static const struct {
        int at;
        uint16_t value;
        const char *why;
    } bad[] = {
        {AT_TRIANGLES, N_VERTICES, "bad triangle"},     /* no such vertex */
        {AT_TRIANGLES + 2, 0, "bad triangle"},          /* the same corner twice */
        {AT_REGION, 0x0004, "unknown region"},          /* (and 0 for vertex 1) */
        {AT_LANDMARKS, N_TRIANGLES, "bad landmark"},    /* no such triangle */
        {AT_LANDMARKS + 2, 1, "reserved bytes"},        /* not 0 */
        {AT_LANDMARKS + 4 + 2, 0x3f80, "bad landmark"}, /* weights sum to 2 */
        {AT_LANDMARKS + 4 + 2, 0xbf80, "bad landmark"}, /* a weight of -1 */
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        uint8_t *file = small_head_model_file();
        (void)iso_put_u16(file + bad[i].at, bad[i].value);
        small_head_model_seal(file, SIZE);
        assert_refused(file, SIZE, bad[i].why);
        free(file);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refuses_every_truncation),
        cmocka_unit_test(refuses_bytes_after_the_end),
        cmocka_unit_test(refuses_every_flipped_byte),
        cmocka_unit_test(refuses_another_version),
        cmocka_unit_test(refuses_more_than_the_largest_file),
        cmocka_unit_test(refuses_counts_out_of_range),
        cmocka_unit_test(refuses_what_is_not_finite),
        cmocka_unit_test(refuses_inconsistent_contents),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
