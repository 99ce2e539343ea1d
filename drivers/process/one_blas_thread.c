/* Runs OpenBLAS without threads of its own. This file is compiled into each program that computes.
 *
 * When OpenBLAS is loaded, before main(), it starts a thread for every other processor. Each thread
 * takes a stack and 32 MiB. If the address space is limited, a thread that gets no memory repeats
 * its request without end, and the program hangs when it waits for the thread at its exit. If the
 * thread cannot be created, the program gets a SIGINT. None of our matrices is large enough to
 * profit from such threads.
 *
 * Only OPENBLAS_NUM_THREADS prevents this, and it must be set before the library is loaded. A
 * program that is started without this variable therefore executes itself again with it. It does so
 * in DT_PREINIT_ARRAY, the only code that runs before the constructors of libraries. The process
 * and everything that it has inherited stay the same. If this is not possible, the program
 * continues without the variable. */
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
