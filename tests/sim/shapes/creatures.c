#include "tests/sim/shapes/creatures.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
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
