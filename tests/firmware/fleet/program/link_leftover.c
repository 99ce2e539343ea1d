#include "tests/firmware/fleet/program/link_leftover.h"

#include <stdio.h>
#include <sys/stat.h>

#include "tests/support/scratch.h"

static const char *const names[] = {"hub/bundle.part", "update.record"};

void link_leftover_make(const char *folder)
{
    char path[300];
    (void)snprintf(path, sizeof path, "%s/hub", folder);
    (void)mkdir(path, 0700); /* it may be there */
    for (unsigned i = 0; i < 2; i++) {
        (void)snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        scratch_write_text(path, "half");
    }
}

bool link_leftover_is_there(const char *folder)
{
    char path[300];
    bool is_there = false;
    for (unsigned i = 0; i < 2; i++) {
        (void)snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        is_there = is_there || scratch_exists(path);
    }
    return is_there;
}
