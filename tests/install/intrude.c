/* Acts like an attacker who has taken over a running process: it makes the first thread of the
 * process execute one system call, and prints the result. Then the process continues.
 *
 *   intrude PID create PATH     opens PATH for writing, and makes it
 *   intrude PID read PATH       opens PATH for reading
 *   intrude PID internet        opens a TCP socket
 *   intrude PID execute PATH    executes PATH
 *   intrude PID realtime        asks for a real-time priority for this thread
 *
 * Prints one word: "done", the name of the error (such as EACCES), or "killed" if the process ended
 * by a signal. Exit status 0 in all of these cases, 1 if it could not try. x86-64 only. */
#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

/* Leaves the 128 bytes below the stack pointer alone, which belong to the function that runs. */
enum { RED_ZONE = 128, PATH_BYTES = 256, SYSCALL_BYTES = 2 };

struct call {
    long number;
    long arguments[4];
    int path_at; /* the argument that is the address of the path; -1: none */
    const char *path;
};

static int fail(const char *what)
{
    fprintf(stderr, "intrude: %s: %s\n", what, strerror(errno));
    return 1;
}

static bool read_call(int argc, char **argv, struct call *call)
{
    const char *what = argc > 2 ? argv[2] : "";
    const char *path = argc > 3 ? argv[3] : "";
    const bool has_path = *path && strlen(path) < PATH_BYTES;
    if (argc == 4 && has_path && strcmp(what, "create") == 0) {
        *call = (struct call){SYS_openat, {AT_FDCWD, 0, O_WRONLY | O_CREAT, 0600}, 1, path};
    } else if (argc == 4 && has_path && strcmp(what, "read") == 0) {
        *call = (struct call){SYS_openat, {AT_FDCWD, 0, O_RDONLY, 0}, 1, path};
    } else if (argc == 3 && strcmp(what, "internet") == 0) {
        *call = (struct call){SYS_socket, {AF_INET, SOCK_STREAM, 0, 0}, -1, NULL};
    } else if (argc == 3 && strcmp(what, "realtime") == 0) {
        /* The bytes of the "path" are those of a struct sched_param with the priority 1. */
        *call = (struct call){SYS_sched_setscheduler, {0, SCHED_FIFO, 0, 0}, 2, "\001"};
    } else if (argc == 4 && has_path && strcmp(what, "execute") == 0) {
        *call = (struct call){SYS_execve, {0, 0, 0, 0}, 0, path};
    } else {
        return false;
    }
    return true;
}

/* Puts the path onto the stack of the process; returns its address there, or 0. */
static unsigned long lend_path(pid_t pid, const char *path, unsigned long stack)
{
    char bytes[PATH_BYTES] = "";
    (void)snprintf(bytes, sizeof bytes, "%s", path);
    const unsigned long at = stack - RED_ZONE - PATH_BYTES;
    const struct iovec from = {bytes, sizeof bytes};
    const struct iovec to = {(void *)at, sizeof bytes};
    return process_vm_writev(pid, &from, 1, &to, 1, 0) == (ssize_t)sizeof bytes ? at : 0;
}

/* The instruction pointer of a waiting process is after its instruction `syscall`; this executes
 * the instruction once more. */
static int prepare(pid_t pid, const struct call *call, const struct user_regs_struct *before)
{
    struct user_regs_struct regs = *before;
    long arguments[4];
    memcpy(arguments, call->arguments, sizeof arguments);
    errno = 0;
    const long code = ptrace(PTRACE_PEEKTEXT, pid, regs.rip - SYSCALL_BYTES, NULL);
    if (errno || (code & 0xffff) != 0x050f) {
        errno = EAGAIN; /* the process does not wait in a system call */
        return -1;
    }
    if (call->path_at >= 0) {
        arguments[call->path_at] = (long)lend_path(pid, call->path, regs.rsp);
        if (!arguments[call->path_at]) {
            return -1;
        }
    }
    regs.rip -= SYSCALL_BYTES;
    regs.rax = (unsigned long)call->number;
    regs.orig_rax = (unsigned long)-1; /* the kernel must not restart the interrupted call now */
    regs.rdi = (unsigned long)arguments[0];
    regs.rsi = (unsigned long)arguments[1];
    regs.rdx = (unsigned long)arguments[2];
    regs.r10 = (unsigned long)arguments[3];
    return ptrace(PTRACE_SETREGS, pid, NULL, &regs) ? -1 : 0;
}

static int tell(pid_t pid, const struct user_regs_struct *before)
{
    struct user_regs_struct after;
    if (ptrace(PTRACE_GETREGS, pid, NULL, &after)) {
        return fail("registers after the call");
    }
    const long result = (long)after.rax;
    puts(result >= 0 ? "done" : strerrorname_np((int)-result));
    return ptrace(PTRACE_SETREGS, pid, NULL, before) || ptrace(PTRACE_DETACH, pid, NULL, NULL)
               ? fail("detach")
               : 0;
}

static int intrude(pid_t pid, const struct call *call)
{
    struct user_regs_struct before;
    int status;
    if (ptrace(PTRACE_ATTACH, pid, NULL, NULL) || waitpid(pid, &status, 0) < 0 ||
        ptrace(PTRACE_GETREGS, pid, NULL, &before)) {
        return fail("attach");
    }
    if (prepare(pid, call, &before)) {
        (void)ptrace(PTRACE_DETACH, pid, NULL, NULL);
        return fail("prepare");
    }
    if (ptrace(PTRACE_SINGLESTEP, pid, NULL, NULL) || waitpid(pid, &status, 0) < 0) {
        return fail("call");
    }
    if (WIFSIGNALED(status)) {
        puts("killed");
        return 0;
    }
    return tell(pid, &before);
}

int main(int argc, char **argv)
{
    struct call call;
    if (!read_call(argc, argv, &call)) {
        fputs("usage: intrude PID create|read|execute PATH, or intrude PID internet|realtime\n",
              stderr);
        return 1;
    }
    return intrude((pid_t)strtol(argv[1], NULL, 10), &call);
}
