#include "tests/sim/shapes/creatures.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/shapes/make/generate.h"

void make_creatures(const char *out, const char *preset, const char *format, size_t classes,
                    int threads)
{
    const struct sim_shapes_options options = {
        .preset = preset,
        .out = out,
        .format = format,
        .seed = 2,
        .classes = classes,
        .shapes = 9,
        .vertices = 400,
        .threads = threads,
    };
    struct iso_fault fault = {.text = ""};
    int32_t n = 0;
    if (sim_shapes_generate(&options, &n, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_int_equal(n, strcmp(preset, "plain") == 0 ? 9 : 24 * (int)classes);
}

int run_study(const struct sim_shapes_study_options *options, char **printed,
              struct iso_fault *fault)
{
    size_t size;
    FILE *out = open_memstream(printed, &size);
    int error = sim_shapes_study(options, out, fault);
    (void)fclose(out);
    return error;
}

double match_error(const struct sim_match_options *options, double *within)
{
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    size_t size;
    double mean = -1.0;
    FILE *out = open_memstream(&printed, &size);
    if (sim_shapes_match(options, out, &fault)) {
        fail_msg("%s", fault.text);
    }
    (void)fclose(out);
    const char *error = strstr(printed, "mean geodesic error ");
    assert_non_null(error);
    assert_int_equal(sscanf(error, "mean geodesic error %lf", &mean), 1);
    if (within) {
        assert_int_equal(sscanf(strstr(error, "0.25: "), "0.25: %lf", within), 1);
    }
    print_message("%s", error);
    free(printed);
    return mean;
}
