/* The large research data sets, which are not part of the project. */
#ifndef TESTS_SUPPORT_SHARED_DATA_H
#define TESTS_SUPPORT_SHARED_DATA_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/support/scratch.h"

/* The data set of this name, in $ISOTHERM_SHARED or else beside the sources. It may be missing. The
 * buffer is one of scratch_path. */
static inline const char *shared_data(const char *name)
{
    const char *shared = getenv("ISOTHERM_SHARED");
    return scratch_path(shared ? shared : ISOTHERM_SOURCE_DIR "/../shared", name);
}

/* The same; skips the running test if the data set is missing. */
static inline const char *shared_data_or_skip(const char *name)
{
    const char *path = shared_data(name);
    if (!scratch_exists(path)) {
        print_message("skipped: %s is missing\n", path);
        skip();
    }
    return path;
}

#endif
