/* isothermd finds another object in the place of a file that it opens: a FIFO, a directory, a
 * symbolic link, a socket, a device, or a file of 8 GiB. It refuses the object in one line that
 * names it. It does not hang, and it does not take more memory than it may.
 *
 * The kernel tells by inotify which files a normal start opens in the test's directory. The test
 * replaces each of them by each kind of object in turn, and starts the real program. A list names
 * the files that do not exist in a normal state. */
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/daemon/opened_files.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

#define PROGRAM ISOTHERM_BINARY_DIR "/firmware/isothermd"
#define DATA    ISOTHERM_SOURCE_DIR "/core/data/"
#define STORED  ISOTHERM_SOURCE_DIR "/sim/stored/p01-enrol/"

enum { SILENCE_MS = 30000 };

static const off_t huge_bytes = (off_t)8 << 30;

static struct private_bus bus;

/* ---- the files ---- */

static void copy_file(const char *from, const char *to)
{
    size_t size;
    void *bytes = scratch_read(from, &size);
    scratch_write(to, bytes, size);
    free(bytes);
}

static void copy_recording(const char *directory)
{
    static const char *const names[] = {"recording.ini", "depth.txt"};
    char path[256], line[256];
    scratch_mkdir(scratch_path(directory, "slot"));
    scratch_mkdir(scratch_path(directory, "slot/depth"));
    for (size_t i = 0; i < 2; i++) {
        (void)snprintf(path, sizeof path, "slot/%s", names[i]);
        (void)snprintf(line, sizeof line, STORED "%s", names[i]);
        copy_file(line, scratch_path(directory, path));
    }
    FILE *list = fopen(STORED "depth.txt", "re");
    assert_non_null(list);
    while (fgets(line, sizeof line, list)) {
        char name[128], from[512];
        if (line[0] != '#' && sscanf(line, "%*s %100s", name) == 1) {
            (void)snprintf(path, sizeof path, "slot/%s", name);
            (void)snprintf(from, sizeof from, STORED "%s", name);
            copy_file(from, scratch_path(directory, path));
        }
    }
    (void)fclose(list);
}

/* Two configurations. Together they name every file that can be named without a camera. */
static const char *const ways[] = {
    "[model]\nhead = $D/head.model\nmetric = $D/face.metric\n[seal]\nkey = $D/key\n",
    "[model]\nhead = $D/head.model\ncohort = $D/cohort.templates\n[match]\nmethod = distance\n",
};

static const char common[] = "[sensor]\npath = $D/slot\nloop = yes\n"
                             "[door]\ninputs = $D/inputs\ncards = $D/cards\n"
                             "[gallery]\npath = $D/g.db\n[log]\npath = $D/a.log\n"
                             "[lockout]\npath = $D/lockout\n";

static const char inputs[] = "contact = 0\nexit_button = 0\ntamper = 0\n";

static void append(FILE *out, const char *text, const char *directory)
{
    for (const char *at = text; *at; at++) {
        if (at[0] == '$' && at[1] == 'D') {
            fputs(directory, out);
            at++;
        } else {
            fputc(*at, out);
        }
    }
}

/* In the second configuration the key is a credential. */
static void write_files(const char *directory, size_t way)
{
    FILE *out = fopen(scratch_path(directory, "c.conf"), "we");
    assert_non_null(out);
    append(out, common, directory);
    append(out, ways[way], directory);
    fprintf(out, "[bus]\naddress = %s\n", bus.address);
    assert_int_equal(fclose(out), 0);
    copy_recording(directory);
    scratch_write_text(scratch_path(directory, "inputs"), inputs);
    scratch_write_text(scratch_path(directory, "cards"), "17 1 anna\n");
    copy_file(DATA "head.model", scratch_path(directory, "head.model"));
    copy_file(DATA "face.metric", scratch_path(directory, "face.metric"));
    copy_file(DATA "cohort.templates", scratch_path(directory, "cohort.templates"));
    scratch_mkdir(scratch_path(directory, "credentials"));
    scratch_write(scratch_path(directory, "credentials/isotherm.key"),
                  "0123456789abcdef0123456789abcdef", 32);
    assert_int_equal(
        way == 1 ? setenv("CREDENTIALS_DIRECTORY", scratch_path(directory, "credentials"), 1)
                 : unsetenv("CREDENTIALS_DIRECTORY"),
        0);
}

/* ---- starting ---- */

static int listen_for_ready(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    assert_true(fd >= 0);
    (void)unlink(path);
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s", path);
    assert_int_equal(bind(fd, (const struct sockaddr *)&address, sizeof address), 0);
    assert_int_equal(setenv("NOTIFY_SOCKET", path, 1), 0);
    return fd;
}

static bool has_ended(const struct run *run)
{
    siginfo_t info = {0};
    return waitid(P_PID, (id_t)run->pid, &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info.si_pid == run->pid;
}

/* Starts the daemon until it is ready or has ended, and ends it. If it becomes ready, it runs until
 * it prints `awaited` (NULL: it ends at once). Returns true if it was ready. */
static bool start(const char *directory, const char *awaited, struct run *run)
{
    const char *const argv[] = {PROGRAM, "--config", scratch_path(directory, "c.conf"), NULL};
    const int fd = listen_for_ready(scratch_path(directory, "notify"));
    struct pollfd notified = {.fd = fd, .events = POLLIN};
    bool ready = false;
    run_start(run, argv);
    for (int waited_ms = 0; !ready && !has_ended(run); waited_ms += 20) {
        char text[256] = "";
        if (waited_ms > SILENCE_MS) {
            (void)kill(run->pid, SIGKILL);
            fail_msg("neither ready nor ended after %d s", SILENCE_MS / 1000);
        }
        ready = poll(&notified, 1, 20) == 1 && recv(fd, text, sizeof text - 1, 0) > 0 &&
                strncmp(text, "READY=1", 7) == 0;
    }
    if (ready) {
        if (awaited) {
            run_until(run, awaited);
        }
        (void)kill(run->pid, SIGTERM);
    }
    run_finish(run);
    (void)close(fd);
    (void)unsetenv("NOTIFY_SOCKET");
    return ready;
}

static void check(const char *directory, struct run *run)
{
    const char *const argv[] = {PROGRAM, "--check-config", "--config",
                                scratch_path(directory, "c.conf"), NULL};
    run_start(run, argv);
    run_finish(run);
}

static void expect_ready(const char *directory)
{
    struct run run;
    const bool ready = start(directory, NULL, &run);
    if (!ready || run.exit != 0) {
        fail_msg("a sound daemon does not start: exit %d, %s", run.exit, run.err);
    }
    run_free(&run);
}

static void find_names(const char *directory, struct names *names)
{
    int watches[FOLDERS];
    expect_ready(directory); /* this start creates the stores */
    const int fd = opened_files_watch(directory, watches);
    expect_ready(directory);
    opened_files_collect(fd, watches, names);
    (void)close(fd);
}

/* ---- the objects ---- */

enum kind { FIFO, DIRECTORY, LINK_TO_THE_FILE, LINK_TO_ZERO, SOCKET, DEVICE, HUGE_FILE, KINDS };

static const char *const kind_names[KINDS] = {
    "FIFO", "directory", "link to the file", "link to /dev/zero", "socket", "device", "8 GiB"};

/* The text that the line about an object of each kind has. */
static const char *const words[KINDS] = {
    "is a FIFO",   "is a directory", "is a symbolic link", "is a symbolic link",
    "is a socket", "is a device",    "longer than"};

static void make_socket(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    assert_true(fd >= 0 && strlen(path) < sizeof address.sun_path);
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s", path);
    assert_int_equal(bind(fd, (const struct sockaddr *)&address, sizeof address), 0);
    (void)close(fd);
}

/* Makes an object at `path`; `away` is the path of the original file. Returns false if this machine
 * does not allow the test to make such an object. */
static bool put(enum kind kind, const char *path, const char *away)
{
    if (kind == HUGE_FILE) { /* it begins like the original file */
        if (scratch_exists(away)) {
            copy_file(away, path);
        } else {
            scratch_write(path, "", 0);
        }
        return truncate(path, huge_bytes) == 0;
    }
    switch (kind) {
    case FIFO:
        return mkfifo(path, 0600) == 0;
    case DIRECTORY:
        return mkdir(path, 0700) == 0;
    case LINK_TO_THE_FILE:
        return symlink(away, path) == 0;
    case LINK_TO_ZERO:
        return symlink("/dev/zero", path) == 0;
    case SOCKET:
        make_socket(path);
        return true;
    default:
        return mknod(path, S_IFCHR | 0600, 1 << 8 | 5) == 0; /* /dev/zero */
    }
}

/* ---- the expected results ---- */

static size_t lines_of(const char *text)
{
    size_t n = 0;
    for (; *text; text++) {
        n += *text == '\n';
    }
    return n;
}

/* A log may have any length. The line about a huge one says that its records are not sound. */
static bool is_named(const char *err, const char *path, enum kind kind)
{
    return strstr(err, path) &&
           (strstr(err, words[kind]) || (kind == HUGE_FILE && strstr(err, "a.log")));
}

static void expect_refusal(const struct run *run, const char *path, enum kind kind)
{
    if (run->exit < 2 || run->exit > 4 || lines_of(run->err) != 1 || *run->out ||
        !is_named(run->err, path, kind)) {
        fail_msg("%s in the place of %s: exit %d, %s%s", kind_names[kind], path, run->exit,
                 run->err, run->out);
    }
}

/* A fault of the sensor or of the door's inputs does not end the daemon: it reports the fault,
 * keeps the door locked and tries again. An object in the place of the lock-out file is a lockdown.
 */
static bool is_tried_again(const char *name)
{
    return strncmp(name, "slot/", 5) == 0 || strcmp(name, "inputs") == 0 ||
           strcmp(name, "lockout") == 0;
}

static void try_start(const char *directory, const char *name, enum kind kind, bool needed)
{
    const char *path = scratch_path(directory, name);
    struct run run;
    const bool again = is_tried_again(name);
    const bool ready = start(directory, again ? path : NULL, &run);
    if (ready && again) {
        assert_true(is_named(run.err, path, kind));
    }
    if (ready && (again || !needed)) {
        assert_int_equal(run.exit, 0);
    } else {
        expect_refusal(&run, path, kind);
    }
    run_free(&run);
    check(directory, &run);
    if (run.exit != 0) {
        expect_refusal(&run, path, kind);
    }
    run_free(&run);
}

/* Puts one object in the place of a file, starts the daemon, and restores the file. A file that is
 * not needed may be missing, and the daemon may start with the object in its place. */
static void try_one(const char *directory, const char *name, enum kind kind, bool needed)
{
    const char *path = scratch_path(directory, name);
    char away[512];
    (void)snprintf(away, sizeof away, "%s.away", path);
    assert_true(rename(path, away) == 0 || !needed);
    if (put(kind, path, away)) {
        try_start(directory, name, kind, needed);
    } else {
        print_message("%s: cannot be made here: %s\n", kind_names[kind], strerror(errno));
    }
    (void)!remove(path);
    assert_true(rename(away, path) == 0 || !needed);
}

/* Names that a normal start looks for or writes, and that do not exist in a normal state. */
static const char *const absent[][10] = {
    {"lockout", "lockout.new", "g.db-journal", "g.db-wal", "g.db.keys.new", "g.db.anchor.new",
     "a.log.anchor.new", "a.log.new", "key.new", NULL},
    {"credentials/isotherm.key.old", NULL},
};

/* Puts each kind of object in the place of the file, unless an earlier configuration had this file.
 * Returns the number of starts. */
static size_t try_kinds(const char *directory, const char *name, bool needed)
{
    static struct names done;
    const size_t before = done.n;
    names_add(&done, "", name);
    if (done.n == before) {
        return 0;
    }
    for (int kind = 0; kind < KINDS; kind++) {
        try_one(directory, name, (enum kind)kind, needed);
    }
    return KINDS;
}

static void odd_files_are_refused(const char *directory, size_t way)
{
    static struct names names;
    size_t tried = 0;
    names.n = 0;
    write_files(directory, way);
    find_names(directory, &names);
    for (size_t i = 0; i < names.n; i++) {
        tried += try_kinds(directory, names.text[i], true);
    }
    for (size_t i = 0; absent[way][i]; i++) {
        tried += try_kinds(directory, absent[way][i], false);
    }
    print_message("%zu starts; %zu files are opened by a sound one\n", tried, names.n);
    assert_true(names.n >= 14);
    expect_ready(directory); /* no start has done harm */
}

static void with_a_metric_and_a_key(void **state)
{
    odd_files_are_refused(*state, 0);
}

static void with_a_cohort_and_a_credential(void **state)
{
    odd_files_are_refused(*state, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(with_a_metric_and_a_key, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(with_a_cohort_and_a_credential, scratch_setup,
                                        scratch_teardown),
    };
    if (!private_bus_start(&bus)) {
        (void)puts("no dbus-daemon");
        return TEST_SKIPPED;
    }
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    private_bus_stop(&bus);
    return failed;
}
