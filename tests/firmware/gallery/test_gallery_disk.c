/* A gallery on a disk that cannot be written or is full, and a gallery that a killed process has
 * left. */
#include <errno.h>
#include <fcntl.h>
#include <linux/capability.h>
#include <signal.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/gallery/gallery.h"
#include "tests/firmware/rigs/gallery_rig.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/support/child_end.h"
#include "tests/support/scratch.h"

enum { CAPACITY = 1000 };

/* ---- other processes, rights, space ---- */

/* Runs `child` in a process of its own. Returns its result. */
static int in_child(int (*child)(const char *directory), const char *directory)
{
    int status = 0;
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        _exit(child(directory));
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    return child_code(status);
}

/* From here on, file modes bind root like every other user. (The test cannot become another user,
 * because that user might not even reach the directory.) */
static int obey_modes(void)
{
    struct __user_cap_header_struct header = {.version = _LINUX_CAPABILITY_VERSION_3};
    struct __user_cap_data_struct data[_LINUX_CAPABILITY_U32S_3];
    if (syscall(SYS_capget, &header, data)) {
        return -errno;
    }
    data[0].effective &= ~(1U << CAP_DAC_OVERRIDE | 1U << CAP_DAC_READ_SEARCH);
    return syscall(SYS_capset, &header, data) ? -errno : 0;
}

static int open_obediently(const char *directory)
{
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {.text = ""};
    if (obey_modes()) {
        return 99;
    }
    const int error = gallery_rig_try_open(directory, &gallery, &fault);
    return strstr(fault.text, "cannot be written") ? -error : 98;
}

static void a_read_only_gallery_is_refused(void **state)
{
    gallery_rig_make(*state, 1);
    assert_int_equal(chmod(*state, 0555), 0);
    assert_int_equal(chmod(scratch_path(*state, "g.db"), 0444), 0);
    child_expect_code("a daemon that may only read", in_child(open_obediently, *state), EROFS, NULL,
                      NULL);
    assert_int_equal(chmod(*state, 0755), 0);
}

/* Adds people until the file may not grow any more. */
static int fill_up(const char *directory)
{
    struct iso_fault fault = {.text = ""};
    struct iso_gallery *gallery = gallery_rig_open(directory);
    const struct rlimit limit = {60000, 60000};
    int added = 0, error;
    if (signal(SIGXFSZ, SIG_IGN) == SIG_ERR || setrlimit(RLIMIT_FSIZE, &limit)) {
        return 99;
    }
    while ((error = gallery_rig_add_number(gallery, added, &fault)) == 0) {
        added++;
    }
    if (error != -ENOSPC ||
        !strstr(fault.text, "the disk refused: No space left on device; nothing was changed")) {
        fprintf(stderr, "%d %s\n", error, fault.text);
        return 98;
    }
    /* The memory is unchanged, too, and the gallery still works. */
    size_t n = 0;
    (void)iso_gallery_people(gallery, &n);
    if ((int)n != added || iso_gallery_remove(gallery, "person 0", &fault)) {
        return 97;
    }
    return added;
}

static void a_full_disk_changes_nothing(void **state)
{
    size_t n = 0;
    const int added = in_child(fill_up, *state);
    assert_in_range(added, 3, 90);
    struct iso_gallery *gallery = gallery_rig_open(*state);
    const struct iso_person *people = iso_gallery_people(gallery, &n);
    assert_int_equal(n, added - 1);
    for (size_t i = 0; i < n; i++) {
        assert_int_equal(people[i].usable, 1);
    }
    iso_gallery_close(gallery);
}

/* ---- kills ---- */

/* Adds and deletes people without end, and reports each change. */
static void write_for_ever(const char *directory, int report_fd)
{
    struct iso_gallery *gallery = NULL;
    if (gallery_rig_try_open(directory, &gallery, NULL)) {
        _exit(1);
    }
    for (int i = 0;; i++) {
        char name[32];
        (void)snprintf(name, sizeof name, "person %d", i - 3);
        if (gallery_rig_add_number(gallery, i, NULL) || write(report_fd, "+", 1) != 1) {
            _exit(2);
        }
        if (i >= 3 && (iso_gallery_remove(gallery, name, NULL) || write(report_fd, "-", 1) != 1)) {
            _exit(3);
        }
    }
}

/* Kills a writer a short time after it has reported `reports` changes. Returns how many it had
 * reported in the end. */
static int kill_a_writer(const char *directory, int reports)
{
    int fds[2], status = 0, n = 0;
    char byte;
    assert_int_equal(pipe(fds), 0);
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        (void)close(fds[0]);
        write_for_ever(directory, fds[1]);
    }
    (void)close(fds[1]);
    while (n < reports && read(fds[0], &byte, 1) == 1) {
        n++;
    }
    for (volatile int spin = 0; spin < 20000 * (reports % 7); spin++) {
    }
    assert_int_equal(kill(pid, SIGKILL), 0);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFSIGNALED(status));
    while (read(fds[0], &byte, 1) == 1) {
        n++;
    }
    (void)close(fds[0]);
    return n;
}

/* Returns how many people there are after that many changes: + + + + - + - + - ... */
static size_t people_after(int changes)
{
    if (changes <= 3) {
        return (size_t)changes;
    }
    return changes % 2 == 0 ? 4 : 3;
}

static void survives_kills(void **state)
{
    for (int round = 0; round < 8; round++) {
        size_t n = 0;
        (void)unlink(scratch_path(*state, "g.db"));
        (void)unlink(scratch_path(*state, "g.db-journal"));
        (void)unlink(scratch_path(*state, "g.db.anchor"));
        const int changes = kill_a_writer(*state, round % 12);
        struct iso_gallery *gallery = gallery_rig_open(*state);
        const struct iso_person *people = iso_gallery_people(gallery, &n);
        /* The reported changes are there; one more change may be there. */
        if (n != people_after(changes) && n != people_after(changes + 1)) {
            fail_msg("after %d changes there are %zu people", changes, n);
        }
        for (size_t i = 0; i < n; i++) {
            assert_int_equal(people[i].usable, 1);
        }
        assert_int_equal(gallery_rig_add_number(gallery, 500, NULL), 0);
        iso_gallery_close(gallery);
    }
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_read_only_gallery_is_refused),
        TEST(a_full_disk_changes_nothing),
        TEST(survives_kills),
    };
    gallery_rig_capacity = CAPACITY;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
