#include "enroll/cli/arguments/value.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

bool cli_value_count(const char *text, unsigned long long max, unsigned long long *out)
{
    char *end;

    if (*text < '0' || *text > '9') {
        return false;
    }
    errno = 0;
    const unsigned long long value = strtoull(text, &end, 10);
    if (errno || *end || value == 0 || value > max) {
        return false;
    }
    *out = value;
    return true;
}

bool cli_value_seconds(const char *text, double *out)
{
    char *end;
    const double value = strtod(text, &end);

    if (end == text || *end || !isfinite(value) || value <= 0 || value > 86400) {
        return false;
    }
    *out = value;
    return true;
}
