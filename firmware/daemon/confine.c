#include "firmware/daemon/confine.h"

#include <errno.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

/* Whether the process may lock all memory that it will ever allocate. The amount of locked memory
 * is limited; beyond it an allocation would fail later. */
static bool may_lock_all(void)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_MEMLOCK, &limit)) {
        return false;
    }
    return limit.rlim_cur == RLIM_INFINITY;
}

int iso_confine_memory(struct iso_fault *fault)
{
    const struct rlimit none = {0, 0};
    (void)setrlimit(RLIMIT_CORE, &none);
    if (prctl(PR_SET_DUMPABLE, 0)) {
        return iso_fault_set_code(fault, ISO_FAULT_NOT_CONFINED, -errno,
                                  "the process stays dumpable: %m");
    }
    if (!may_lock_all()) {
        return iso_fault_set_code(
            fault, ISO_FAULT_NOT_CONFINED, -EPERM,
            "memory is not locked: the limit of locked memory is not infinite");
    }
    if (mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT)) {
        return iso_fault_set_code(fault, ISO_FAULT_NOT_CONFINED, -errno,
                                  "memory is not locked: %m");
    }
    return 0;
}
