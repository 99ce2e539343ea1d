/* seccomp: the system calls that the daemon, its libraries and their threads use. The list comes
 * from systemd's group @system-service (systemd.exec(5)). It lacks calls that start programs, that
 * change users or the priorities of other processes, and that change scheduling policies: the
 * real-time threads have been started before (drivers/process/thread.h). It also lacks sockets that
 * reach beyond the machine. */
#include <errno.h>
#include <seccomp.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "firmware/daemon/confine.h"

static const char *const allowed[] = {
    /* files and descriptors */
    "access",
    "chdir",
    "close",
    "close_range",
    "copy_file_range",
    "creat",
    "dup",
    "dup2",
    "dup3",
    "faccessat",
    "faccessat2",
    "fadvise64",
    "fallocate",
    "fchdir",
    "fchmod",
    "fchmodat",
    "fchown",
    "fchown32",
    "fcntl",
    "fcntl64",
    "fdatasync",
    "flock",
    "fstat",
    "fstat64",
    "fstatat64",
    "fstatfs",
    "fstatfs64",
    "fsync",
    "ftruncate",
    "ftruncate64",
    "getcwd",
    "getdents",
    "getdents64",
    "inotify_add_watch",
    "inotify_init",
    "inotify_init1",
    "inotify_rm_watch",
    "ioctl",
    "link",
    "linkat",
    "lseek",
    "_llseek",
    "lstat",
    "lstat64",
    "memfd_create",
    "mkdir",
    "mkdirat",
    "newfstatat",
    "open",
    "openat",
    "openat2",
    "pipe",
    "pipe2",
    "pread64",
    "preadv",
    "preadv2",
    "pwrite64",
    "pwritev",
    "pwritev2",
    "read",
    "readahead",
    "readlink",
    "readlinkat",
    "readv",
    "rename",
    "renameat",
    "renameat2",
    "rmdir",
    "sendfile",
    "sendfile64",
    "splice",
    "stat",
    "stat64",
    "statfs",
    "statfs64",
    "statx",
    "sync_file_range",
    "truncate",
    "truncate64",
    "umask",
    "unlink",
    "unlinkat",
    "utimensat",
    "write",
    "writev",
    /* waiting */
    "epoll_create",
    "epoll_create1",
    "epoll_ctl",
    "epoll_pwait",
    "epoll_pwait2",
    "epoll_wait",
    "eventfd",
    "eventfd2",
    "_newselect",
    "poll",
    "ppoll",
    "pselect6",
    "select",
    "signalfd",
    "signalfd4",
    "timerfd_create",
    "timerfd_gettime",
    "timerfd_settime",
    /* local sockets; a separate rule limits socket() itself */
    "accept",
    "accept4",
    "bind",
    "connect",
    "getpeername",
    "getsockname",
    "getsockopt",
    "listen",
    "recv",
    "recvfrom",
    "recvmmsg",
    "recvmsg",
    "send",
    "sendmmsg",
    "sendmsg",
    "sendto",
    "setsockopt",
    "shutdown",
    "socketpair",
    /* memory */
    "brk",
    "get_mempolicy",
    "madvise",
    "mbind",
    "membarrier",
    "mincore",
    "mlock",
    "mlock2",
    "mlockall",
    "mmap",
    "mmap2",
    "mprotect",
    "mremap",
    "msync",
    "munlock",
    "munlockall",
    "munmap",
    "pkey_alloc",
    "pkey_free",
    "pkey_mprotect",
    "remap_file_pages",
    "set_mempolicy",
    /* threads of the libraries; a new process would be of no use without execve() */
    "arch_prctl",
    "clone",
    "clone3",
    "exit",
    "exit_group",
    "futex",
    "futex_time64",
    "futex_waitv",
    "get_robust_list",
    "get_thread_area",
    "gettid",
    "rseq",
    "sched_getaffinity",
    "sched_getattr",
    "sched_getparam",
    "sched_get_priority_max",
    "sched_get_priority_min",
    "sched_getscheduler",
    "sched_yield",
    "set_robust_list",
    "set_thread_area",
    "set_tid_address",
    /* signals, times, and the identity of the process */
    "alarm",
    "clock_getres",
    "clock_getres_time64",
    "clock_gettime",
    "clock_gettime64",
    "clock_nanosleep",
    "clock_nanosleep_time64",
    "getcpu",
    "getegid",
    "getegid32",
    "geteuid",
    "geteuid32",
    "getgid",
    "getgid32",
    "getgroups",
    "getgroups32",
    "getitimer",
    "getpgid",
    "getpgrp",
    "getpid",
    "getppid",
    "getpriority",
    "getrandom",
    "getresgid",
    "getresgid32",
    "getresuid",
    "getresuid32",
    "getrlimit",
    "getrusage",
    "getsid",
    "gettimeofday",
    "getuid",
    "getuid32",
    "kill",
    "nanosleep",
    "pause",
    "prctl",
    "prlimit64",
    "restart_syscall",
    "rt_sigaction",
    "rt_sigpending",
    "rt_sigprocmask",
    "rt_sigqueueinfo",
    "rt_sigreturn",
    "rt_sigsuspend",
    "rt_sigtimedwait",
    "rt_sigtimedwait_time64",
    "setitimer",
    "sigaltstack",
    "sigreturn",
    "sysinfo",
    "tgkill",
    "time",
    "timer_create",
    "timer_delete",
    "timer_getoverrun",
    "timer_gettime",
    "timer_settime",
    "times",
    "ugetrlimit",
    "uname",
    "wait4",
    "waitid",
    "waitpid",
};

/* Neither the daemon nor a library makes these calls. If one is made, an attacker made it. */
static const char *const fatal[] = {
    "execve",
    "execveat",
    "ptrace",
    "process_vm_readv",
    "process_vm_writev",
    "mount",
    "umount2",
    "pivot_root",
    "chroot",
    "unshare",
    "setns",
    "init_module",
    "finit_module",
    "delete_module",
    "kexec_load",
    "kexec_file_load",
    "bpf",
    "perf_event_open",
    "userfaultfd",
    "reboot",
    "swapon",
    "setuid",
    "setgid",
    "setreuid",
    "setregid",
    "setresuid",
    "setresgid",
    "setgroups",
    "capset",
    "keyctl",
    "add_key",
    "request_key",
    "iopl",
    "ioperm",
    "settimeofday",
    "clock_settime",
};

static const int families[] = {AF_UNIX, AF_NETLINK};

/* Adds rules for the calls that exist on this machine; a call that does not exist needs no rule. */
static int add_rules(scmp_filter_ctx filter, uint32_t action, const char *const *names, size_t n)
{
    int error = 0;
    for (size_t i = 0; !error && i < n; i++) {
        const int number = seccomp_syscall_resolve_name(names[i]);
        if (number != __NR_SCMP_ERROR) {
            error = seccomp_rule_add(filter, action, number, 0);
        }
    }
    return error;
}

static int build_filter(scmp_filter_ctx filter)
{
    int error = add_rules(filter, SCMP_ACT_ALLOW, allowed, sizeof allowed / sizeof *allowed);
    if (!error) {
        error = add_rules(filter, SCMP_ACT_KILL_PROCESS, fatal, sizeof fatal / sizeof *fatal);
    }
    for (size_t i = 0; !error && i < sizeof families / sizeof *families; i++) {
        const struct scmp_arg_cmp is_family = {
            .arg = 0, .op = SCMP_CMP_EQ, .datum_a = (scmp_datum_t)families[i], .datum_b = 0};
        error = seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, SCMP_SYS(socket), 1, &is_family);
    }
    /* The filter applies to every thread, also to threads that the libraries have started. */
    return error ? error : seccomp_attr_set(filter, SCMP_FLTATR_CTL_TSYNC, 1);
}

/* libseccomp 2.5 needs some 400 kB for a filter, and ends the process by a signal if it gets
 * less. */
static bool has_room(void)
{
    void *volatile room = malloc(ISO_CONFINE_CALLS_BYTES);
    free(room);
    return room != NULL;
}

int iso_confine_calls(struct iso_fault *fault)
{
#ifdef ISOTHERM_INSTRUMENTED
    return iso_fault_set_code(fault, ISO_FAULT_NOT_CONFINED, -ENOTSUP,
                              "this build is instrumented and confines nothing");
#endif
    scmp_filter_ctx filter = has_room() ? seccomp_init(SCMP_ACT_ERRNO(EPERM)) : NULL;
    if (!filter) {
        return iso_fault_set(fault, -ENOMEM, "calls are not confined: out of memory");
    }
    int error = build_filter(filter);
    if (!error) {
        error = seccomp_load(filter);
    }
    seccomp_release(filter);
    return error ? iso_fault_set_code(fault, ISO_FAULT_NOT_CONFINED, error,
                                      "calls are not confined: %s", strerror(-error))
                 : 0;
}
