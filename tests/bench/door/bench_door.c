/* Measures how long the door takes when everything else is slow: the daemon has a disk that takes
 * 10 s for an fsync, frames that take 500 ms, and a client of the bus that does not read. The
 * program presses the exit button and prints the times from the button's edge to the relay, and the
 * difference between the relay's time and unlock_ms. The thread that presses has a higher real-time
 * priority than the door's thread, as an interrupt has; otherwise the program would measure its own
 * delays. For the latest presses it prints what delayed them (press_log.h, processor_watch.h).
 *
 * usage: bench_door DAEMON PRELOAD RECORDING DATA [PRESSES] */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <systemd/sd-bus.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "firmware/contract/contract.h"
#include "tests/bench/door/door_bench.h"
#include "tests/bench/door/press_log.h"
#include "tests/bench/door/processor_watch.h"
#include "tests/bench/door/thread_account.h"
#include "tests/bench/machine.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/scratch.h"

enum {
    PRESSES = 1000,
    PRIORITY = 50, /* of the thread that presses */
    UNLOCK_MS = 100,
    DEBOUNCE_MS = 10, /* the daemon's own default */
    BOUND_MS = 20,
    PRESS_MS = 30, /* how long the button is held */
    PAUSE_MS = 25, /* between the relay's end and the next press */
    SYNC_MS = 10000,
    FRAME_MS = 500,
    READY_MS = 60000,
    PATIENCE_MS = 60000,
};

static struct {
    struct private_bus bus;
    char *directory;
    struct door_bench *shared;
    int memory_fd, edges[2], switchings[2], notify_fd;
    pid_t daemon, door; /* door: the thread */
    sd_bus *deaf;
    struct bench_watch *watch;
    struct bench_press *presses;
} bench;

static void give_up(const char *what)
{
    fprintf(stderr, "bench_door: %s: %s\n", what, strerror(errno));
    if (bench.daemon > 0) {
        (void)kill(bench.daemon, SIGKILL);
    }
    private_bus_stop(&bench.bus);
    exit(1);
}

static int64_t now_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

static void wait_ms(long ms)
{
    const struct timespec wait = {ms / 1000, ms % 1000 * 1000000L};
    (void)nanosleep(&wait, NULL);
}

/* ---- the daemon ---- */

static void write_configuration(const char *path, const char *recording, const char *data)
{
    char text[4096];
    (void)snprintf(text, sizeof text,
                   "[sensor]\nbackend = replay\npath = %s\nloop = yes\n"
                   "stale_ms = 600000\npause_ms = 600000\nsilence_ms = 600000\n"
                   "[door]\nbackend = gpiod\nrelay = bench:%d\nexit_button = bench:%d\n"
                   "unlock_ms = %d\n"
                   "[gallery]\npath = %s/gallery.db\n[log]\npath = %s/audit.log\n"
                   "[bus]\naddress = %s\n"
                   "[model]\nhead = %s/head.model\nmetric = %s/face.metric\n",
                   recording, DOOR_BENCH_RELAY, DOOR_BENCH_EXIT, UNLOCK_MS, bench.directory,
                   bench.directory, bench.bus.address, data, data);
    scratch_write_text(path, text);
}

static void connect_lines(void)
{
    char text[64];
    bench.memory_fd = memfd_create("bench_door", 0);
    if (bench.memory_fd < 0 || ftruncate(bench.memory_fd, sizeof *bench.shared) ||
        pipe(bench.edges) || pipe(bench.switchings)) {
        give_up("pipes");
    }
    bench.shared = mmap(NULL, sizeof *bench.shared, PROT_READ | PROT_WRITE, MAP_SHARED,
                        bench.memory_fd, 0);
    if (bench.shared == MAP_FAILED) {
        give_up("memory");
    }
    (void)fcntl(bench.edges[0], F_SETFL, O_NONBLOCK);
    (void)snprintf(text, sizeof text, "%d %d %d", bench.memory_fd, bench.edges[0],
                   bench.switchings[1]);
    (void)setenv(DOOR_BENCH_VARIABLE, text, 1);
}

static void listen_to_daemon(void)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%.90s/notify", bench.directory);
    bench.notify_fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (bench.notify_fd < 0 ||
        bind(bench.notify_fd, (const struct sockaddr *)&address, sizeof address)) {
        give_up("notify");
    }
    (void)setenv("NOTIFY_SOCKET", address.sun_path, 1);
}

/* Runs the daemon in this process. It may lock its memory, as its systemd unit allows. */
static void become_daemon(const char *program, const char *preload, const char *configuration)
{
    const struct rlimit all = {RLIM_INFINITY, RLIM_INFINITY};
    const int log_fd = open(scratch_path(bench.directory, "log"), O_WRONLY | O_CREAT | O_CLOEXEC,
                            0600);
    (void)dup2(log_fd, STDERR_FILENO);
    (void)setrlimit(RLIMIT_MEMLOCK, &all);
    (void)setenv("LD_PRELOAD", preload, 1);
    (void)execl(program, program, "--config", configuration, (char *)NULL);
    _exit(127);
}

static void start_daemon(const char *program, const char *preload, const char *configuration)
{
    struct pollfd ready = {.fd = bench.notify_fd, .events = POLLIN};
    char text[256] = "";
    bench.daemon = fork();
    if (bench.daemon == 0) {
        become_daemon(program, preload, configuration);
    }
    while (!strstr(text, "READY=1")) {
        if (poll(&ready, 1, READY_MS) != 1) {
            give_up("the daemon is not ready");
        }
        const ssize_t n = recv(bench.notify_fd, text, sizeof text - 1, 0);
        text[n > 0 ? n : 0] = '\0';
    }
    bench.door = bench_thread_named(bench.daemon, "isothermd-door");
    if (bench.door == 0) {
        errno = ESRCH;
        give_up("the door's thread");
    }
}

/* Connects a client that subscribes to every signal and reads none. */
static void connect_deaf_client(void)
{
    sd_bus_slot *slot = NULL;
    int r = sd_bus_new(&bench.deaf);
    r = r < 0 ? r : sd_bus_set_address(bench.deaf, bench.bus.address);
    r = r < 0 ? r : sd_bus_set_bus_client(bench.deaf, 1);
    r = r < 0 ? r : sd_bus_start(bench.deaf);
    r = r < 0 ? r
              : sd_bus_match_signal(bench.deaf, &slot, NULL, NULL, ISO_CONTRACT_INTERFACE, NULL,
                                    NULL, NULL);
    if (r < 0) {
        errno = -r;
        give_up("the bus");
    }
}

/* ---- presses ---- */

static int64_t set_button(int level)
{
    const struct door_bench_edge edge = {now_ns(), DOOR_BENCH_EXIT, level};
    atomic_store(&bench.shared->level[DOOR_BENCH_EXIT], level);
    if (write(bench.edges[1], &edge, sizeof edge) != sizeof edge) {
        give_up("an edge");
    }
    return edge.t_ns;
}

/* Waits until the daemon has switched the relay to this level. */
static struct door_bench_switching await_relay(int level)
{
    struct door_bench_switching switching = {.level = -1};
    struct pollfd ready = {.fd = bench.switchings[0], .events = POLLIN};
    while (switching.line != DOOR_BENCH_RELAY || switching.level != level) {
        if (poll(&ready, 1, PATIENCE_MS) != 1) {
            errno = ETIMEDOUT;
            give_up("the relay");
        }
        if (read(bench.switchings[0], &switching, sizeof switching) != sizeof switching) {
            give_up("a switching");
        }
    }
    return switching;
}

/* Asks the watch how late the processors were during the press. A watching thread notes a delay
 * only when it runs again, so this is asked after the pause. */
static void ask_watch(struct bench_press *press)
{
    if (bench.watch) {
        press->to_on.stopped_ns = bench_watch_late_ns(bench.watch, press->pressed_ns,
                                                      press->on.t_ns);
        press->to_off.stopped_ns = bench_watch_late_ns(bench.watch, press->on.t_ns,
                                                       press->off.t_ns);
    }
}

static struct bench_wait accounts(void)
{
    return (struct bench_wait){
        .door = bench_account_of(bench.daemon, bench.door),
        .own = bench_account_of(getpid(), getpid()),
    };
}

static struct bench_wait between(const struct bench_wait *earlier, const struct bench_wait *later)
{
    return (struct bench_wait){
        .door = bench_account_between(&earlier->door, &later->door),
        .own = bench_account_between(&earlier->own, &later->own),
    };
}

static void press(int i)
{
    struct bench_press *press = &bench.presses[i];
    const struct bench_wait before = accounts();
    press->pressed_ns = set_button(1);
    press->written_ns = now_ns();
    wait_ms(PRESS_MS);
    (void)set_button(0);
    press->on = await_relay(1);
    const struct bench_wait at_on = accounts();
    press->off = await_relay(0);
    const struct bench_wait at_off = accounts();
    press->to_on = between(&before, &at_on);
    press->to_off = between(&at_on, &at_off);
    wait_ms(PAUSE_MS + i % 17);
    ask_watch(press);
}

/* ---- figures ---- */

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_times(const char *what, double *ms, int n, double most_ms)
{
    int above = 0;
    for (int i = 0; i < n; i++) {
        above += ms[i] > most_ms || ms[i] < -most_ms;
    }
    qsort(ms, (size_t)n, sizeof *ms, by_value);
    printf("%-28s median %7.2f ms, 99 %% %7.2f ms, least %7.2f ms, most %7.2f ms; beyond %g ms: "
           "%d of %d\n",
           what, ms[n / 2], ms[n * 99 / 100], ms[0], ms[n - 1], most_ms, above, n);
}

static void count_losses(void)
{
    size_t size = 0;
    char *log = scratch_read(scratch_path(bench.directory, "log"), &size);
    printf("frames of %d ms meanwhile: %d; fsync of %d s: %d; the daemon logged %zu bytes\n",
           FRAME_MS, atomic_load(&bench.shared->frames), SYNC_MS / 1000,
           atomic_load(&bench.shared->syncs), size);
    free(log);
}

/* Prints how the threads were scheduled, and how late the processors were. */
static void print_conditions(int64_t stolen_ns)
{
    char door[64], own[64];
    printf("the door's thread: %s; the thread that presses: %s; locked memory of the daemon: %ld "
           "MiB\n",
           bench_thread_policy(bench.door, door, sizeof door),
           bench_thread_policy(getpid(), own, sizeof own), bench_locked_kib(bench.daemon) / 1024);
    if (bench.watch) {
        const struct bench_watch_total total = bench_watch_total(bench.watch);
        printf("processors: %d of %d wakings of the highest priority were late by over 1 ms, the "
               "latest by %.2f ms; ",
               total.late, total.wakings, (double)total.latest_ns / 1e6);
    } else {
        printf("processors: not watched, because this process may not use real-time priorities; ");
    }
    printf("the host took %.0f ms of them\n", (double)stolen_ns / 1e6);
}

static void print_presses(int presses)
{
    const struct bench_press_bounds bounds = {DEBOUNCE_MS, UNLOCK_MS, BOUND_MS};
    double *to_line_ms = calloc((size_t)presses, sizeof *to_line_ms);
    double *off_error_ms = calloc((size_t)presses, sizeof *off_error_ms);
    if (!to_line_ms || !off_error_ms) {
        give_up("the figures");
    }
    for (int i = 0; i < presses; i++) {
        to_line_ms[i] = bench_press_to_line_ms(&bench.presses[i]);
        off_error_ms[i] = bench_press_off_error_ms(&bench.presses[i], UNLOCK_MS);
    }
    print_times("exit button, edge to relay:", to_line_ms, presses, BOUND_MS);
    print_times("relay, off against unlock_ms:", off_error_ms, presses, BOUND_MS);
    bench_press_print_latest(bench.presses, presses, &bounds, bench.watch != NULL);
    free(to_line_ms);
    free(off_error_ms);
}

static void measure(int presses)
{
    const struct sched_param priority = {.sched_priority = PRIORITY};
    bench.presses = calloc((size_t)presses, sizeof *bench.presses);
    if (!bench.presses) {
        give_up("the presses");
    }
    bench.watch = bench_watch_start();
    (void)sched_setscheduler(0, SCHED_FIFO, &priority);
    const struct bench_account before = bench_account_of(getpid(), getpid());
    atomic_store(&bench.shared->frames, 0);
    atomic_store(&bench.shared->syncs, 0);
    atomic_store(&bench.shared->sync_ms, SYNC_MS);
    atomic_store(&bench.shared->frame_ms, FRAME_MS);
    for (int i = 0; i < presses; i++) {
        press(i);
    }
    const struct bench_account after = bench_account_of(getpid(), getpid());
    bench_print_machine();
    print_conditions(after.stolen_ns - before.stolen_ns);
    print_presses(presses);
    count_losses();
    bench_watch_stop(bench.watch);
    free(bench.presses);
}

int main(int argc, char **argv)
{
    void *directory = NULL;
    if (argc < 5 || argc > 6) {
        fprintf(stderr, "usage: bench_door DAEMON PRELOAD RECORDING DATA [PRESSES]\n");
        return 2;
    }
    const int presses = argc == 6 ? (int)strtol(argv[5], NULL, 10) : PRESSES;
    if (presses < 1 || !private_bus_start(&bench.bus) || scratch_setup(&directory)) {
        return 1;
    }
    bench.directory = directory;
    const char *configuration = scratch_path(bench.directory, "c.conf");
    write_configuration(configuration, argv[3], argv[4]);
    connect_lines();
    listen_to_daemon();
    start_daemon(argv[1], argv[2], configuration);
    connect_deaf_client();
    measure(presses);
    atomic_store(&bench.shared->sync_ms, 0);
    (void)kill(bench.daemon, SIGKILL); /* an orderly end would take minutes on its slow disk */
    (void)waitpid(bench.daemon, NULL, 0);
    sd_bus_unref(bench.deaf);
    private_bus_stop(&bench.bus);
    return scratch_teardown(&directory);
}
