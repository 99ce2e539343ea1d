/* A shared object that is a module, or nearly one. The build makes several variants, each with one
 * fault (tests/drivers/CMakeLists.txt). */
#include "tests/drivers/module/fake_module.h"

#ifndef FAKE_ABI
#define FAKE_ABI ISO_MODULE_ABI
#endif
#ifndef FAKE_NAME
#define FAKE_NAME "fake"
#endif
#ifndef FAKE_VERSION
#define FAKE_VERSION ISOTHERM_VERSION
#endif
#ifndef FAKE_SIZE
#define FAKE_SIZE sizeof(struct fake_module)
#endif
#ifndef FAKE_SYMBOL
#define FAKE_SYMBOL iso_module
#endif

extern const struct fake_module FAKE_SYMBOL;

static int answer(void)
{
    return FAKE_ANSWER;
}

#ifdef FAKE_NEEDS_MORE
int fake_function_of_a_library_that_is_missing(void);
#define FAKE_FUNCTION fake_function_of_a_library_that_is_missing
#else
#define FAKE_FUNCTION answer
#endif

const struct fake_module FAKE_SYMBOL = {
    .module = {.abi = FAKE_ABI,
               .size_bytes = FAKE_SIZE,
               .name = FAKE_NAME,
               .version = FAKE_VERSION},
    .answer = answer,
    .more = FAKE_FUNCTION,
};
