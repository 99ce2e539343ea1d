/* Runs OpenBLAS without threads of its own. This file is compiled into each program that computes.
 *
 * OpenBLAS starts its threads when it is loaded, which is before main(): one thread for each
 * processor except the first. Each thread needs memory for its stack and 32 MiB for its buffers.
 * Two faults can occur if the address space is limited. A thread that cannot get its memory tries
 * again and never stops, so the program hangs when it waits for the thread at its exit. If a thread
 * cannot be created, OpenBLAS sends SIGINT to the program. The threads would gain nothing, because
 * none of our matrices is large enough.
 *
 * Only the environment variable OPENBLAS_NUM_THREADS prevents this, and it must be set before the
 * library is loaded. If it is not set, the program sets it and executes itself again. This happens
 * in DT_PREINIT_ARRAY, because no other code runs before the constructors of the libraries. The
 * process keeps its number and everything that it has inherited. If the program cannot execute
 * itself again, it continues without the variable. */
#include <limits.h>
#include <stddef.h>
#include <string.h>
#include <sys/auxv.h>
#include <unistd.h>

/* No ordinary environment has so many variables. */
enum { ENVIRONMENT_MAX = 4096 };

static void start_again_without_threads(int argc, char **argv, char **environment)
{
    static const char name[] = "OPENBLAS_NUM_THREADS=";
    static char setting[] = "OPENBLAS_NUM_THREADS=1";
    static char *with_setting[ENVIRONMENT_MAX + 2];
    static char path[PATH_MAX];
    size_t n = 0;
    (void)argc;
    if (getauxval(AT_BASE) == 0) {
        return;
        /* The loader was called by its own name, so /proc/self/exe is the loader. */
    }
    for (; environment[n]; n++) {
        if (n == ENVIRONMENT_MAX || strncmp(environment[n], name, sizeof name - 1) == 0) {
            return;
        }
        with_setting[n] = environment[n];
    }
    with_setting[n] = setting;
    const ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
    if (length > 0) {
        path[length] = '\0';
        (void)execve(path, argv, with_setting);
    }
}

__attribute__((section(".preinit_array"),
               used)) static void (*const first)(int argc, char **argv,
                                                 char **environment) = start_again_without_threads;
