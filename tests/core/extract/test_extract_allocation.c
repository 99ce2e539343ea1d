/* An extractor allocates memory only when it is created. The creation survives every allocation
 * that fails. The test compiles core into itself, so that the linker's --wrap affects core, but not
 * CHOLMOD and LAPACK. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "isotherm/extract.h"
#include "tests/core/surfaces/rendered_head.h"
#include "tests/core/surfaces/shipped_model.h"
#include "tests/support/memory/scarce_memory.h"

enum { ALLOCATIONS_MAX = 200 };

static void frames_are_run_without_allocating(void **state)
{
    (void)state;
    struct iso_head_model *model = shipped_head_model();
    struct iso_frame *frame = rendered_head_frame();
    struct iso_extract_options options = iso_extract_options_default();
    struct iso_extractor *extractor = NULL;
    struct iso_extraction *out = calloc(1, sizeof *out);
    assert_non_null(out);
    assert_int_equal(iso_extractor_new(model, &options, &extractor), 0);
    const struct iso_vec3 places[] = {{0, 0, 600}, {30, 10, 500}, {-40, 0, 800}, {0, 0, 2000}};
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        struct iso_rigid pose = rendered_head_pose(5.0 * (double)i, 3.0, places[i]);
        rendered_head_clear(frame);
        rendered_head_draw(frame, model, NULL, 1.0, &pose);
        scarce_memory_left = ALLOCATIONS_MAX;
        assert_int_equal(iso_extractor_run(extractor, frame, out), 0);
        assert_int_equal(scarce_memory_left, ALLOCATIONS_MAX);
        scarce_memory_left = -1;
        assert_int_equal(out->outcome == ISO_CAPTURE_OK, i < 3);
    }
    iso_extractor_free(extractor);
    iso_frame_free(frame);
    iso_head_model_free(model);
    free(out);
}

static void a_new_extractor_survives_any_failed_allocation(void **state)
{
    (void)state;
    struct iso_head_model *model = shipped_head_model();
    struct iso_extract_options options = iso_extract_options_default();
    int n = 0;
    for (int error = -ENOMEM; error; n++) {
        char untouched;
        struct iso_extractor *extractor = (struct iso_extractor *)(void *)&untouched;
        scarce_memory_left = n;
        error = iso_extractor_new(model, &options, &extractor);
        bool reached = scarce_memory_left < 0;
        scarce_memory_left = -1;
        if (error) {
            assert_true(reached);
            assert_int_equal(error, -ENOMEM);
            assert_ptr_equal(extractor, &untouched);
            assert_true(n < ALLOCATIONS_MAX);
        } else {
            iso_extractor_free(extractor);
        }
    }
    assert_true(n > 40);
    iso_head_model_free(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_are_run_without_allocating),
        cmocka_unit_test(a_new_extractor_survives_any_failed_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
