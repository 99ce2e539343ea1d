#include "enroll/policy_reader/confine.h"

#include <errno.h>
#include <seccomp.h>
#include <stddef.h>
#include <sys/prctl.h>
#include <sys/resource.h>

enum { CPU_S = 5, MEMORY_BYTES = 512 << 20 };

static int limit(int resource, rlim_t most)
{
    const struct rlimit limits = {most, most};
    return setrlimit(resource, &limits) < 0 ? -errno : 0;
}

static int limit_resources(void)
{
    int error = limit(RLIMIT_CPU, CPU_S);
#ifndef ISOTHERM_SANITIZED
    error = error != 0 ? error : limit(RLIMIT_AS, MEMORY_BYTES);
#endif
    error = error != 0 ? error : limit(RLIMIT_CORE, 0);
    return error != 0 ? error : limit(RLIMIT_NOFILE, 0);
}

#ifdef ISOTHERM_SANITIZED
/* The sanitizers look at the process from another one when it ends. */
static int limit_calls(void)
{
    return 0;
}
#else
/* Only calls that the C library uses for memory, for descriptors that are open, and for the end. */
static const int allowed[] = {
    SCMP_SYS(read),         SCMP_SYS(write),
    SCMP_SYS(writev),       SCMP_SYS(close),
    SCMP_SYS(fstat),        SCMP_SYS(fstat64),
    SCMP_SYS(newfstatat),   SCMP_SYS(lseek),
    SCMP_SYS(_llseek),      SCMP_SYS(brk),
    SCMP_SYS(mmap),         SCMP_SYS(mmap2),
    SCMP_SYS(munmap),       SCMP_SYS(mremap),
    SCMP_SYS(mprotect),     SCMP_SYS(madvise),
    SCMP_SYS(futex),        SCMP_SYS(futex_time64),
    SCMP_SYS(getrandom),    SCMP_SYS(rt_sigreturn),
    SCMP_SYS(rt_sigaction), SCMP_SYS(rt_sigprocmask),
    SCMP_SYS(gettid),       SCMP_SYS(getpid),
    SCMP_SYS(tgkill),       SCMP_SYS(clock_gettime),
    SCMP_SYS(gettimeofday), SCMP_SYS(exit),
    SCMP_SYS(exit_group),
};

static int limit_calls(void)
{
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
    int error = filter ? 0 : -ENOMEM;
    for (size_t i = 0; error == 0 && i < sizeof allowed / sizeof *allowed; i++) {
        error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, allowed[i], 0);
    }
    error = error != 0 ? error : seccomp_load(filter);
    seccomp_release(filter);
    return error;
}
#endif

int reader_confine(void)
{
    if (prctl(PR_SET_DUMPABLE, 0L, 0L, 0L, 0L) < 0) {
        return -errno;
    }
    const int error = limit_resources();
    return error != 0 ? error : limit_calls();
}
