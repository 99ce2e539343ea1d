#include "tests/enroll/rigs/read_text.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "tests/support/scratch.h"

char *read_text(const char *path)
{
    size_t size;
    char *bytes = scratch_read(path, &size);
    char *text = strndup(bytes, size);

    free(bytes);
    assert_non_null(text);
    return text;
}
