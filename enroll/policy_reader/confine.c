#include "enroll/policy_reader/confine.h"

#include <errno.h>
#include <seccomp.h>
#include <stddef.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

enum { CPU_S = 5, MEMORY_BYTES = 512 << 20 };

static int limit(int resource, rlim_t most)
{
    const struct rlimit limits = {most, most};
    return setrlimit(resource, &limits) < 0 ? -errno : 0;
}

/* When a process ends, its sanitizers look at it from another one, which needs files and memory. */
static int limit_resources(void)
{
    int error = limit(RLIMIT_CPU, CPU_S);
    error = error != 0 ? error : limit(RLIMIT_CORE, 0);
#ifndef ISOTHERM_SANITIZED
    error = error != 0 ? error : limit(RLIMIT_AS, MEMORY_BYTES);
    error = error != 0 ? error : limit(RLIMIT_NOFILE, 0);
    if (error == 0 && prctl(PR_SET_DUMPABLE, 0L, 0L, 0L, 0L) < 0) {
        error = -errno;
    }
#endif
    return error;
}

#ifdef ISOTHERM_SANITIZED
static int limit_calls(void)
{
    return 0;
}
#else
/* Only calls that the C library uses for memory, for descriptors that are open, and for the end. */
static const int allowed[] = {
    SCMP_SYS(read),           SCMP_SYS(write),
    SCMP_SYS(writev),         SCMP_SYS(close),
    SCMP_SYS(fstat),          SCMP_SYS(fstat64),
    SCMP_SYS(newfstatat),     SCMP_SYS(lseek),
    SCMP_SYS(_llseek),        SCMP_SYS(brk),
    SCMP_SYS(munmap),         SCMP_SYS(mremap),
    SCMP_SYS(madvise),        SCMP_SYS(futex),
    SCMP_SYS(futex_time64),   SCMP_SYS(getrandom),
    SCMP_SYS(rt_sigreturn),   SCMP_SYS(rt_sigaction),
    SCMP_SYS(rt_sigprocmask), SCMP_SYS(gettid),
    SCMP_SYS(getpid),         SCMP_SYS(tgkill),
    SCMP_SYS(clock_gettime),  SCMP_SYS(gettimeofday),
    SCMP_SYS(exit),           SCMP_SYS(exit_group),
};
/* The same, with memory that holds no code. */
static const int without_code[] = {SCMP_SYS(mmap), SCMP_SYS(mmap2), SCMP_SYS(mprotect)};

static int limit_calls(void)
{
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
    int error = filter ? 0 : -ENOMEM;
    for (size_t i = 0; error == 0 && i < sizeof allowed / sizeof *allowed; i++) {
        error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, allowed[i], 0);
    }
    for (size_t i = 0; error == 0 && i < sizeof without_code / sizeof *without_code; i++) {
        error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, without_code[i], 1,
                                 SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0));
    }
    error = error != 0 ? error : seccomp_load(filter);
    seccomp_release(filter);
    return error;
}
#endif

int reader_confine(void)
{
    const int error = limit_resources();
    return error != 0 ? error : limit_calls();
}
