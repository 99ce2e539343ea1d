/* The limits of a confined process. Each case is a child process that confines itself and tries
 * something. It ends with the error of the attempt, or a signal ends it. */
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/process/thread.h"
#include "firmware/daemon/confine.h"
#include "tests/support/child_end.h"
#include "tests/support/scratch.h"

enum { CANNOT = 200 };

static struct iso_config config;
static char inside[4096];

/* cmocka set-up: the scratch directory has a directory "state" for the stores. */
static int setup(void **state)
{
    const int error = scratch_setup(state);
    config = iso_config_default();
    (void)snprintf(config.sensor.backend, sizeof config.sensor.backend, "v4l2");
    scratch_mkdir(scratch_path(*state, "state"));
    (void)snprintf(config.gallery.path, sizeof config.gallery.path, "%s",
                   scratch_path(*state, "state/gallery.db"));
    (void)snprintf(config.log.path, sizeof config.log.path, "%s",
                   scratch_path(*state, "state/audit.log"));
    (void)snprintf(inside, sizeof inside, "%s", scratch_path(*state, "state/new"));
    return error;
}

/* Returns 0 or the errno that `try` got in a confined child; negative: the signal that ended the
 * child. */
static int attempt(int (*try)(void))
{
    int status = 0;
    fflush(NULL);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        struct iso_fault fault = {.text = ""};
        int error = iso_confine_files(&config, &fault);
        if (!error) {
            error = iso_confine_calls(&fault);
        }
        if (error) {
            _exit(error == -ENOSYS || error == -ENOTSUP ? CANNOT : CANNOT + 1);
        }
        _exit(try());
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    if (WIFSIGNALED(status)) {
        return -WTERMSIG(status);
    }
    if (WEXITSTATUS(status) == CANNOT) {
        print_message("this build or kernel confines nothing\n");
        skip();
    }
    if (WEXITSTATUS(status) == CANNOT + 1) {
        fail_msg("the process could not be confined: see iso_confine_files, iso_confine_calls");
    }
    return WEXITSTATUS(status);
}

static int try_open(const char *path, int flags)
{
    return open(path, flags | O_CLOEXEC, 0600) < 0 ? errno : 0;
}

static int write_inside(void)
{
    return try_open(inside, O_RDWR | O_CREAT) || rename(inside, config.log.path) ||
           unlink(config.log.path);
}

static int write_outside(void)
{
    return try_open("/etc/isotherm-test", O_WRONLY | O_CREAT);
}

static int read_outside(void)
{
    /* The scratch directories are in the directory of temporary files, which the process may use.
     */
    return try_open("/root", O_RDONLY | O_DIRECTORY);
}

static int read_system(void)
{
    return try_open("/etc/passwd", O_RDONLY);
}

static int truncate_outside(void)
{
    return truncate("/etc/passwd", 1 << 20) ? errno : 0;
}

static int execute(void)
{
    execl("/bin/true", "true", (char *)NULL);
    return errno;
}

static int trace(void)
{
    return ptrace(PTRACE_TRACEME, 0, NULL, NULL) ? errno : 0;
}

static int become_root(void)
{
    return setuid(0) ? errno : 0;
}

static int internet(void)
{
    return socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0) < 0 ? errno : 0;
}

static int local(void)
{
    return socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0) < 0 ? errno : 0;
}

static int device_news(void)
{
    return socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, 15) < 0 ? errno : 0;
}

static int become_realtime(void)
{
    const struct sched_param parameters = {.sched_priority = 1};
    return sched_setscheduler(0, SCHED_FIFO, &parameters) ? errno : 0;
}

static int change_priority(void)
{
    const struct sched_param parameters = {.sched_priority = 0};
    return sched_setparam(0, &parameters) ? errno : 0;
}

static void *nothing(void *context)
{
    return context;
}

static int start_a_realtime_thread(void)
{
    pthread_t thread;
    bool realtime = true;
    const int error = iso_thread_start_realtime(&thread, nothing, NULL, 1, &realtime);
    return error ? -error : pthread_join(thread, NULL) || realtime;
}

static void *ask_policy(void *context)
{
    int *policy = context;
    *policy = sched_getscheduler(0);
    return NULL;
}

/* The door's thread does the same when its lines come back: the sender of card numbers gets a new
 * thread. */
static void *confine_and_pass_on(void *context)
{
    int *result = context, policy = -1;
    pthread_t thread;
    bool realtime = false;
    struct iso_fault fault;
    *result = CANNOT;
    if (iso_confine_calls(&fault) == 0) {
        const int error = iso_thread_start_realtime(&thread, ask_policy, &policy, 1, &realtime);
        *result = error || pthread_join(thread, NULL) || !realtime || policy != SCHED_FIFO;
    }
    return NULL;
}

/* Returns 0 if a real-time thread of a confined process has started another real-time thread. */
static int pass_priority_on(void)
{
    pthread_t thread;
    bool realtime = false;
    int result = CANNOT;
    if (iso_thread_start_realtime(&thread, confine_and_pass_on, &result, 1, &realtime) ||
        pthread_join(thread, NULL)) {
        return 1;
    }
    return realtime ? result : CANNOT;
}

static void its_stores_can_be_written(void **state)
{
    (void)state;
    assert_int_equal(attempt(write_inside), 0);
}

static void other_files_cannot_be_written(void **state)
{
    (void)state;
    assert_int_equal(attempt(write_outside), EACCES);
    assert_int_equal(attempt(truncate_outside), EACCES);
}

static void files_that_are_not_named_cannot_be_read(void **state)
{
    (void)state;
    assert_int_equal(attempt(read_outside), EACCES);
    assert_int_equal(attempt(read_system), 0);
}

/* A file whose path is in an option can be read if the back end's table says that the option is a
 * path. */
static void a_path_in_an_option_can_be_read(void **state)
{
    static const struct iso_option_spec file = {.name = "camera", .kind = ISO_OPTION_PATH};
    static const struct iso_option_spec text = {.name = "device", .kind = ISO_OPTION_TEXT};
    struct iso_config_options *const classes[] = {&config.sensor.options, &config.door.options};
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        *classes[i] = (struct iso_config_options){.n = 1, .list = {{&text, "/root/camera", 1}}};
        assert_int_equal(attempt(read_outside), EACCES);
        classes[i]->list[0].spec = &file;
        assert_int_equal(attempt(read_outside), 0);
        assert_int_equal(attempt(write_outside), EACCES);
        classes[i]->n = 0;
    }
}

static void a_replayed_recording_may_be_anywhere(void **state)
{
    (void)state;
    (void)snprintf(config.sensor.backend, sizeof config.sensor.backend, "replay");
    assert_int_equal(attempt(read_outside), 0);
    assert_int_equal(attempt(write_outside), EACCES);
}

/* The folder of the product's library, and the folder around it. Both are "" if the library is in a
 * place where the process may read every file. find_library() sets them. */
static char folder[4096], around[4096];

static int find_library(struct dl_phdr_info *library, size_t size, void *context)
{
    static const char *const open_to_all[] = {"/usr/", "/lib",  "/etc/",     "/sys/", "/proc/",
                                              "/run/", "/dev/", "/var/tmp/", "/tmp/"};
    (void)size;
    (void)context;
    if (!strstr(library->dlpi_name, "/libisotherm-core.so")) {
        return 0;
    }
    for (size_t i = 0; i < sizeof open_to_all / sizeof *open_to_all; i++) {
        if (strncmp(library->dlpi_name, open_to_all[i], strlen(open_to_all[i])) == 0) {
            return 0;
        }
    }
    (void)snprintf(folder, sizeof folder, "%s", library->dlpi_name);
    *strrchr(folder, '/') = '\0';
    (void)snprintf(around, sizeof around, "%s", folder);
    *strrchr(around, '/') = '\0';
    return 1;
}

static int read_library(void)
{
    char path[sizeof folder + 32];
    (void)snprintf(path, sizeof path, "%s/libisotherm-core.so", folder);
    return try_open(path, O_RDONLY) || try_open(folder, O_RDONLY | O_DIRECTORY);
}

static int write_library(void)
{
    char path[sizeof folder + 32];
    (void)snprintf(path, sizeof path, "%s/new", folder);
    return try_open(path, O_WRONLY | O_CREAT);
}

static int read_around_library(void)
{
    return try_open(around, O_RDONLY | O_DIRECTORY);
}

/* A library may load its parts from its own folder. The process may open nothing else there. */
static void files_beside_a_library_can_be_read(void **state)
{
    (void)state;
    (void)dl_iterate_phdr(find_library, NULL);
    if (!*folder || !*around) {
        print_message("the library is in a place where every file may be read\n");
        skip();
    }
    assert_int_equal(attempt(read_library), 0);
    assert_int_equal(attempt(write_library), EACCES);
    assert_int_equal(attempt(read_around_library), EACCES);
}

static void it_cannot_become_another_program(void **state)
{
    (void)state;
    assert_int_equal(attempt(execute), -SIGSYS);
    assert_int_equal(attempt(trace), -SIGSYS);
    assert_int_equal(attempt(become_root), -SIGSYS);
}

static void it_has_no_network(void **state)
{
    (void)state;
    assert_int_equal(attempt(internet), EPERM);
    assert_int_equal(attempt(local), 0);
    assert_int_equal(attempt(device_news), 0);
}

/* A thread of ordinary priority keeps it, whatever limits the process has. */
static void it_cannot_become_realtime(void **state)
{
    (void)state;
    assert_int_equal(attempt(become_realtime), EPERM);
    assert_int_equal(attempt(change_priority), EPERM);
    assert_int_equal(attempt(start_a_realtime_thread),
                     0); /* the new thread has ordinary priority */
}

static void a_realtime_thread_passes_its_priority_on(void **state)
{
    int status = 0;
    (void)state;
    fflush(NULL);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        _exit(pass_priority_on());
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    if (WEXITSTATUS(status) == CANNOT) {
        print_message("no real-time thread may be started here, or this build confines nothing\n");
        skip();
    }
    assert_int_equal(WEXITSTATUS(status), 0);
}

/* It depends on the present limit whether the memory can be locked. If it cannot, a fault says why.
 * A core file is never written. */
static void its_memory_stays_its_own(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct rlimit core, locked;
    struct child child;
    (void)state;
    assert_int_equal(getrlimit(RLIMIT_MEMLOCK, &locked), 0);
    if (child_fork(&child, "a daemon that confines its memory") == 0) {
        const int error = iso_confine_memory(&fault);
        const bool right = locked.rlim_cur == RLIM_INFINITY
                               ? error == 0 || fault.text[0]
                               : error == -EPERM && strstr(fault.text, "not locked");
        const bool no_core = getrlimit(RLIMIT_CORE, &core) == 0 && core.rlim_max == 0;
        fprintf(stderr, "memory %d (%s), no core %d\n", error, fault.text, (int)no_core);
        _exit(right && no_core ? 0 : 1);
    }
    child_expect(&child, 0);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        TEST(its_stores_can_be_written),
        TEST(other_files_cannot_be_written),
        TEST(files_that_are_not_named_cannot_be_read),
        TEST(a_path_in_an_option_can_be_read),
        TEST(a_replayed_recording_may_be_anywhere),
        TEST(it_cannot_become_another_program),
        TEST(it_has_no_network),
        TEST(its_memory_stays_its_own),
        TEST(files_beside_a_library_can_be_read),
        TEST(it_cannot_become_realtime),
        TEST(a_realtime_thread_passes_its_priority_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
