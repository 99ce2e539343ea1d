#include "drivers/base/restart_hours.h"

#include <errno.h>
#include <stdio.h>

static bool is_hour(int hour)
{
    return hour >= 0 && hour < 24;
}

int iso_restart_hours_read(const char *text, struct iso_restart_hours *out)
{
    struct iso_restart_hours read = {.from = 0};
    int end = 0;
    if (sscanf(text, "%2d-%2d%n", &read.from, &read.until, &end) != 2 || text[end] ||
        !is_hour(read.from) || !is_hour(read.until) || read.from == read.until) {
        return -EINVAL;
    }
    *out = read;
    return 0;
}

bool iso_restart_hours_have(const struct iso_restart_hours *hours, int hour)
{
    if (hours->from == hours->until) {
        return true;
    }
    return hours->from < hours->until ? hour >= hours->from && hour < hours->until
                                      : hour >= hours->from || hour < hours->until;
}
