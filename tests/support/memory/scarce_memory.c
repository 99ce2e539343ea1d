#include "tests/support/memory/scarce_memory.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

long scarce_memory_left = -1;

static bool denied(void)
{
    return scarce_memory_left >= 0 && scarce_memory_left-- == 0;
}

void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *old, size_t size);
void *__real_reallocarray(void *old, size_t n, size_t size);
char *__real_strdup(const char *text);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *old, size_t size);
void *__wrap_reallocarray(void *old, size_t n, size_t size);
char *__wrap_strdup(const char *text);

void *__wrap_malloc(size_t size)
{
    return denied() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t n, size_t size)
{
    return denied() ? NULL : __real_calloc(n, size);
}

void *__wrap_realloc(void *old, size_t size)
{
    return denied() ? NULL : __real_realloc(old, size);
}

void *__wrap_reallocarray(void *old, size_t n, size_t size)
{
    return denied() ? NULL : __real_reallocarray(old, n, size);
}

char *__wrap_strdup(const char *text)
{
    return denied() ? NULL : __real_strdup(text);
}

int scarce_memory_exhaust(int (*action)(void *context, struct iso_fault *fault), void *context,
                          int most)
{
    for (int n = 0; n < most; n++) {
        struct iso_fault fault = {.text = ""};
        scarce_memory_left = n;
        const int error = action(context, &fault);
        const bool all_went_well = scarce_memory_left >= 0;
        scarce_memory_left = -1;
        if (all_went_well) {
            assert_int_equal(error, 0);
            return n;
        }
        assert_int_equal(error, -ENOMEM);
        assert_non_null(strstr(fault.text, "out of memory"));
    }
    fail_msg("never went well");
    return 0;
}
