/* Blocks that are wiped, in a program that checks the sizes of blocks as packages do. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/base/wipe.h"

/* The C library gives a large block whole pages, so that the block is larger than asked for. The
 * heap of the sanitizers gives exactly this size. */
enum { LARGE = 267200 };

static void a_block_that_is_larger_than_asked_for_is_wiped(void **state)
{
    (void)state;
    unsigned char *large = calloc(1, LARGE);
    assert_non_null(large);
    large[LARGE - 1] = 1;
    assert_true(malloc_usable_size(large) >= LARGE);
    iso_wipe_free(large);
    iso_wipe_free(NULL);
}

static void a_block_grows_with_its_items(void **state)
{
    (void)state;
    uint32_t *few = calloc(2, sizeof *few);
    assert_non_null(few);
    few[0] = 7;
    few[1] = 8;
    uint32_t *many = iso_wipe_grow(few, 2, LARGE, sizeof *many);
    assert_non_null(many);
    assert_true(many[0] == 7 && many[1] == 8 && many[2] == 0 && many[LARGE - 1] == 0);
    iso_wipe_free(many);
    many = iso_wipe_grow(NULL, 0, 3, sizeof *many);
    assert_non_null(many);
    assert_true(many[0] == 0 && many[2] == 0);
    iso_wipe_free(many);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_block_that_is_larger_than_asked_for_is_wiped),
        cmocka_unit_test(a_block_grows_with_its_items),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
