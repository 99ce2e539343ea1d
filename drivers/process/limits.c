#include "drivers/process/limits.h"

#include <errno.h>
#include <stdio.h>
#include <sys/resource.h>

int iso_limits_check(const char *program)
{
    struct rlimit stack;
    if (getrlimit(RLIMIT_STACK, &stack) || stack.rlim_cur == RLIM_INFINITY ||
        stack.rlim_cur >= ISO_STACK_LEAST_BYTES) {
        return 0;
    }
    fprintf(stderr, "%s: the stack is limited to %llu KiB, which is less than %d KiB (ulimit -s)\n",
            program, (unsigned long long)stack.rlim_cur / 1024, ISO_STACK_LEAST_BYTES / 1024);
    return -ENOMEM;
}
