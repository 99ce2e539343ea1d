/* The .npy reader on files that the test writes, valid and damaged. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/world/face/npy.h"
#include "tests/support/scratch.h"

static const float six[6] = {0.0f, -1.5f, 3.25f, 65504.0f, 0.0625f, -0.0f};

struct bytes {
    unsigned char data[512];
    size_t n;
};

/* A version 1.0 file as NumPy writes it: the header is padded to a multiple of 64. */
static struct bytes npy(const char *dictionary, const void *data, size_t n_data)
{
    struct bytes b = {.n = 0};
    memcpy(b.data, "\x93NUMPY\x01\x00\x76\x00", 10);
    memset(b.data + 10, ' ', 118);
    memcpy(b.data + 10, dictionary, strlen(dictionary));
    b.data[127] = '\n';
    memcpy(b.data + 128, data, n_data);
    b.n = 128 + n_data;
    return b;
}

static struct bytes good(void)
{
    return npy("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }", six, sizeof six);
}

static int read_floats(const char *directory, const struct bytes *b, struct sim_npy_shape *shape,
                       float **values, struct iso_fault *fault)
{
    const char *path = scratch_path(directory, "a.npy");
    scratch_write(path, b->data, b->n);
    return sim_npy_read_floats(path, shape, values, fault);
}

static void refused(const char *directory, const struct bytes *b)
{
    struct sim_npy_shape shape = {.n_dimensions = -7};
    struct iso_fault fault = {.text = ""};
    float *values = NULL;
    assert_int_equal(read_floats(directory, b, &shape, &values, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "a.npy: "));
    assert_null(values);
    assert_int_equal(shape.n_dimensions, -7);
}

static void floats_come_back(void **state)
{
    struct bytes b = good();
    struct sim_npy_shape shape;
    float *values = NULL;
    assert_int_equal(read_floats(*state, &b, &shape, &values, NULL), 0);
    assert_int_equal(shape.n_dimensions, 2);
    assert_int_equal(shape.size[0], 2);
    assert_int_equal(shape.size[1], 3);
    assert_memory_equal(values, six, sizeof six);
    free(values);
}

static void version_2_is_read(void **state)
{
    struct bytes b = good();
    struct sim_npy_shape shape;
    float *values = NULL;
    memmove(b.data + 12, b.data + 10, b.n - 10);
    memcpy(b.data + 6, "\x02\x00\x76\x00\x00\x00", 6);
    b.n += 2;
    assert_int_equal(read_floats(*state, &b, &shape, &values, NULL), 0);
    assert_memory_equal(values, six, sizeof six);
    free(values);
}

static void halves_are_widened(void **state)
{
    static const unsigned char halves[] = {0x00, 0x3c, 0x00, 0xbe, 0xff, 0x7b};
    struct bytes b = npy("{'descr': '<f2', 'fortran_order': False, 'shape': (3,), }", halves, 6);
    struct sim_npy_shape shape;
    float *values = NULL;
    assert_int_equal(read_floats(*state, &b, &shape, &values, NULL), 0);
    assert_int_equal(shape.n_dimensions, 1);
    assert_int_equal(shape.size[0], 3);
    assert_true(values[0] == 1.0f && values[1] == -1.5f && values[2] == 65504.0f);
    free(values);
}

/* IEEE 754-2008, table 3.5 */
static void every_kind_of_half(void **state)
{
    (void)state;
    assert_true(sim_npy_float_of_half(0x0001) == 0x1p-24f);
    assert_true(sim_npy_float_of_half(0x03ff) == 1023.0f * 0x1p-24f);
    assert_true(sim_npy_float_of_half(0x0400) == 0x1p-14f);
    assert_true(sim_npy_float_of_half(0x3555) == 1365.0f / 4096.0f);
    assert_true(sim_npy_float_of_half(0xfc00) == -INFINITY);
    assert_true(isnan(sim_npy_float_of_half(0x7e00)));
    assert_true(signbit(sim_npy_float_of_half(0x8000)));
}

static void integers_come_back(void **state)
{
    static const unsigned char numbers[] = {1, 2, 3, 4, 0xff, 0xff, 0xff, 0xff};
    struct bytes b = npy("{'descr': '<u4', 'fortran_order': False, 'shape': (1, 2), }", numbers, 8);
    struct sim_npy_shape shape;
    uint32_t *values = NULL;
    const char *path = scratch_path(*state, "n.npy");
    scratch_write(path, b.data, b.n);
    assert_int_equal(sim_npy_read_u32(path, &shape, &values, NULL), 0);
    assert_true(values[0] == 0x04030201u && values[1] == UINT32_MAX);
    free(values);
    refused(*state, &b); /* as floats */
    b = good();
    scratch_write(path, b.data, b.n);
    assert_int_equal(sim_npy_read_u32(path, &shape, &values, NULL), -EBADMSG);
}

static void every_truncation_is_refused(void **state)
{
    struct bytes b = good();
    for (size_t n = b.n; n-- > 0;) {
        struct bytes cut = b;
        cut.n = n;
        refused(*state, &cut);
    }
    b.n++;
    refused(*state, &b);
}

static void other_kinds_of_array_are_refused(void **state)
{
    static const char *const dictionaries[] = {
        "{'descr': '>f4', 'fortran_order': False, 'shape': (2, 3), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }",
        "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 3), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2, 3), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (0, 3), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (2 3), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (-2, 3), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (99999, 99999, 99999), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), 'x': 1}",
        "{'descr': '<f4', 'shape': (2, 3), 'fortran_order': False, }",
        "{'descr': '<f4 and more', 'fortran_order': False, 'shape': (2, 3), }",
    };
    for (size_t i = 0; i < sizeof dictionaries / sizeof *dictionaries; i++) {
        struct bytes b = npy(dictionaries[i], six, sizeof six);
        refused(*state, &b);
    }
}

static void other_files_are_refused(void **state)
{
    struct bytes magic = good(), version = good();
    struct sim_npy_shape shape;
    float *values = NULL;
    struct iso_fault fault = {.text = ""};
    magic.data[1] = 'n';
    refused(*state, &magic);
    version.data[6] = 3;
    refused(*state, &version);
    const char *nowhere = scratch_path(*state, "nowhere.npy");
    assert_int_equal(sim_npy_read_floats(nowhere, &shape, &values, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "nowhere.npy"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(floats_come_back),
        cmocka_unit_test(version_2_is_read),
        cmocka_unit_test(halves_are_widened),
        cmocka_unit_test(every_kind_of_half),
        cmocka_unit_test(integers_come_back),
        cmocka_unit_test(every_truncation_is_refused),
        cmocka_unit_test(other_kinds_of_array_are_refused),
        cmocka_unit_test(other_files_are_refused),
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
