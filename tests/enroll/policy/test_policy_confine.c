/* What isotherm-policy-reader cannot do once it is confined. Each act is tried by a process of its
 * own. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "enroll/policy_reader/confine.h"

static bool opens(void)
{
    return open("/etc/passwd", O_RDONLY | O_CLOEXEC) >= 0;
}

static bool creates(void)
{
    return open("/tmp/isotherm-confine", O_WRONLY | O_CREAT | O_CLOEXEC, 0600) >= 0;
}

static bool connects(void)
{
    return socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0) >= 0;
}

static bool duplicates(void)
{
    return dup(STDOUT_FILENO) >= 0;
}

static bool forks(void)
{
    return fork() >= 0;
}

static bool runs(void)
{
    execl("/bin/true", "true", NULL);
    return false;
}

static bool kills(void)
{
    return kill(getppid(), 0) == 0;
}

static bool takes_memory(void)
{
    return malloc((size_t)600 << 20) != NULL;
}

static bool makes_code(void)
{
    return mmap(NULL, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) !=
           MAP_FAILED;
}

/* A control: this must work. */
static bool reads_and_allocates(void)
{
    char *memory = malloc(4 << 20);
    char c = 'x';
    const bool well = memory != NULL && read(STDIN_FILENO, &c, 0) == 0;
    free(memory);
    return well;
}

/* Returns the exit code of a process that does the act, or 1000 and the signal. */
static int try(bool (*act)(void), bool confined)
{
    int status = 0;
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        if (confined && reader_confine() != 0) {
            _exit(77);
        }
        _exit(act() ? 10 : 20);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

static void nothing_leads_out(void **state)
{
    static bool (*const acts[])(void) = {opens, creates,    connects, duplicates,
                                         forks, makes_code, kills,    takes_memory};

    (void)state;
    for (size_t i = 0; i < sizeof acts / sizeof *acts; i++) {
        assert_int_equal(try(acts[i], false), 10);
        assert_int_equal(try(acts[i], true), 20);
    }
    assert_int_equal(try(runs, false), 0);
    assert_int_equal(try(runs, true), 20);
    assert_int_equal(try(reads_and_allocates, true), 10);
    (void)unlink("/tmp/isotherm-confine");
}

static bool spins(void)
{
    volatile bool on = true;
    while (on) {
    }
    return true;
}

static void it_cannot_run_for_ever(void **state)
{
    (void)state;
    assert_int_equal(try(spins, true), 1000 + SIGKILL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_leads_out),
        cmocka_unit_test(it_cannot_run_for_ever),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
