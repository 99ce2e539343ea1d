/* The factory reset, killed before every call by which it changes the disk: afterwards either
 * everything is as before, or the stores cannot be opened until the reset is finished, and then
 * nothing of the owner is left. */
#include <errno.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/daemon/components.h"
#include "firmware/reset/reset.h"
#include "tests/firmware/rigs/state_rig.h"
#include "tests/support/child_end.h"
#include "tests/support/devices/fake_gpio.h"
#include "tests/support/scratch.h"

/* ---- calls that change the disk, one of which kills the process ---- */

static int calls_left = -1; /* before the kill; -1: never */

static void count_call(void)
{
    if (calls_left == 0) {
        (void)raise(SIGKILL);
    }
    calls_left -= calls_left > 0;
}

#define COUNTED(name, parameters, arguments) \
    int __real_##name parameters;            \
    int __wrap_##name parameters;            \
    int __wrap_##name parameters             \
    {                                        \
        count_call();                        \
        return __real_##name arguments;      \
    }

COUNTED(unlink, (const char *path), (path))
COUNTED(remove, (const char *path), (path))
COUNTED(rename, (const char *from, const char *to), (from, to))
COUNTED(fsync, (int fd), (fd))

ssize_t __real_write(int fd, const void *bytes, size_t size);
ssize_t __wrap_write(int fd, const void *bytes, size_t size);
ssize_t __wrap_write(int fd, const void *bytes, size_t size)
{
    count_call();
    return __real_write(fd, bytes, size);
}

ssize_t __real_pwrite(int fd, const void *bytes, size_t size, off_t at);
ssize_t __wrap_pwrite(int fd, const void *bytes, size_t size, off_t at);
ssize_t __wrap_pwrite(int fd, const void *bytes, size_t size, off_t at)
{
    count_call();
    return __real_pwrite(fd, bytes, size, at);
}

/* ---- an appliance that has an owner ---- */

static FILE *nowhere; /* for what a reset prints */

/* Everything that a test looks at. */
struct owned {
    char state[128], web[128], link[128], credential[128];
    struct mix_state files; /* of the state directory */
};

static void write_folders(const struct owned *owned)
{
    scratch_write_text(scratch_path(owned->web, "accounts"), "ada administrator");
    scratch_mkdir(scratch_path(owned->link, "replies"));
    scratch_write_text(scratch_path(scratch_path(owned->link, "replies"), "1"), "people");
    scratch_write_text(scratch_path(owned->link, "door.key"), "secret");
    scratch_write_text(owned->credential, "encrypted key");
}

/* Makes the stores once. They have people, a log with segments, a lock-out file and their keys. */
static void begin(const char *scratch, struct owned *owned)
{
    (void)snprintf(owned->state, sizeof owned->state, "%s/isotherm", scratch);
    (void)snprintf(owned->web, sizeof owned->web, "%s/web", scratch);
    (void)snprintf(owned->link, sizeof owned->link, "%s/link", scratch);
    (void)snprintf(owned->credential, sizeof owned->credential, "%s/credential", scratch);
    scratch_mkdir(owned->state);
    scratch_mkdir(owned->web);
    scratch_mkdir(owned->link);
    write_folders(owned);
    state_rig_begin(owned->state, &owned->files);
    mix_let_go(&owned->files);
    scratch_write_text(scratch_path(owned->state, "settings"), "settings");
    scratch_write_text(scratch_path(owned->state, "gallery.database"), "of somebody else");
    mix_take(owned->state, &owned->files);
    assert_non_null(mix_find(&owned->files, "gallery.db"));
    assert_non_null(mix_find(&owned->files, "gallery.db.key"));
    assert_non_null(mix_find(&owned->files, "gallery.db.keys"));
    assert_non_null(mix_find(&owned->files, "lockout"));
}

static struct iso_config config_of(const struct owned *owned)
{
    struct iso_config config = iso_config_default();
    (void)snprintf(config.gallery.path, sizeof config.gallery.path, "%s/gallery.db", owned->state);
    (void)snprintf(config.log.path, sizeof config.log.path, "%s/audit.log", owned->state);
    (void)snprintf(config.reset.web, sizeof config.reset.web, "%s", owned->web);
    (void)snprintf(config.reset.link, sizeof config.reset.link, "%s", owned->link);
    (void)snprintf(config.reset.credential, sizeof config.reset.credential, "%s",
                   owned->credential);
    return config;
}

/* ---- what is left ---- */

/* Whether any file of the state directory has these bytes. */
static bool has_bytes(const struct mix_state *files, const void *bytes, size_t size)
{
    for (size_t i = 0; i < files->n; i++) {
        if (files->files[i].size >= size &&
            memmem(files->files[i].bytes, files->files[i].size, bytes, size)) {
            return true;
        }
    }
    return false;
}

static void expect_reset(const struct owned *owned)
{
    struct mix_state now;
    struct iso_fault fault = {.text = ""};
    size_t people = 1;
    mix_take(owned->state, &now);
    /* One file does not belong to the gallery, though its name begins in the same way. */
    assert_int_equal(now.n, 1);
    assert_string_equal(now.files[0].name, "gallery.database");
    mix_let_go(&now);
    assert_int_equal(rmdir(owned->web), 0); /* it is empty */
    assert_int_equal(rmdir(owned->link), 0);
    assert_false(scratch_exists(owned->credential));
    struct iso_components *components = state_rig_open(owned->state);
    (void)iso_gallery_people(components->gallery, &people);
    assert_int_equal(people, 0);
    assert_int_equal(iso_audit_first(components->audit), 1);
    state_rig_close(components);
    assert_int_equal(state_rig_try(owned->state, &fault), 0);
}

/* Everything is as before, byte for byte. */
static void expect_as_before(const struct owned *owned)
{
    char names[MIX_FILES_MAX][MIX_NAME_SIZE];
    struct iso_fault fault = {.text = ""};
    struct mix_state now;
    (void)unlink(scratch_path(owned->state, "factory-reset.new")); /* it means nothing */
    mix_take(owned->state, &now);
    assert_int_equal(mix_differing(&owned->files, &now, names), 0);
    mix_let_go(&now);
    assert_true(scratch_exists(scratch_path(owned->web, "accounts")));
    assert_true(scratch_exists(scratch_path(owned->link, "door.key")));
    assert_true(scratch_exists(owned->credential));
    assert_int_equal(state_rig_try(owned->state, &fault), 0);
    mix_put_back(owned->state, &owned->files); /* opening the stores may have written to them */
}

/* A reset that was begun: nobody is admitted, because the stores are not opened. If a file of
 * people or of the log is gone, so are the keys with which the others could be read. */
static void expect_closed(const struct owned *owned)
{
    const struct mix_file *key = mix_find(&owned->files, "gallery.db.key");
    struct iso_fault fault = {.text = ""};
    struct mix_state now;
    assert_int_equal(state_rig_try(owned->state, &fault), -EBUSY);
    assert_non_null(strstr(fault.text, "a factory reset was begun"));
    mix_take(owned->state, &now);
    if (!mix_find(&now, "gallery.db") || !mix_find(&now, "audit.log") ||
        !scratch_exists(scratch_path(owned->web, "accounts"))) {
        assert_false(has_bytes(&now, key->bytes, key->size));
        assert_null(mix_find(&now, "gallery.db.keys"));
        assert_false(scratch_exists(owned->credential));
    }
    mix_let_go(&now);
}

/* ---- tests ---- */

/* Resets in a process that is killed before call number `at`. Returns false if it was not killed.
 */
static bool reset_until(const struct owned *owned, int at)
{
    const struct iso_config config = config_of(owned);
    struct iso_fault fault = {.text = ""};
    int status = 0;
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        calls_left = at;
        const int error = iso_components_reset(&config, nowhere, &fault);
        calls_left = -1;
        _exit(error ? 1 : 0);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(child_code(status) == 0 || child_code(status) == 1000 + SIGKILL);
    return child_code(status) != 0;
}

static void restore(const struct owned *owned)
{
    mix_put_back(owned->state, &owned->files);
    if (!scratch_exists(owned->web)) {
        scratch_mkdir(owned->web);
        scratch_mkdir(owned->link);
    }
    (void)unlink(scratch_path(scratch_path(owned->link, "replies"), "1"));
    (void)rmdir(scratch_path(owned->link, "replies"));
    write_folders(owned);
}

static void a_reset_that_is_killed_at_any_call_is_finished_or_was_never_begun(void **state)
{
    const struct iso_times times = iso_times_system();
    struct owned owned;
    int kills = 0, before = 0;
    begin(*state, &owned);
    const struct iso_config config = config_of(&owned);
    for (;; kills++) {
        struct iso_fault remark = {.text = ""}, fault = {.text = ""};
        restore(&owned);
        const bool killed = reset_until(&owned, kills);
        const bool begun = scratch_exists(scratch_path(owned.state, "factory-reset"));
        const bool ended = !scratch_exists(scratch_path(owned.state, "gallery.db.key"));
        if (begun) {
            expect_closed(&owned);
        } else if (!ended) {
            expect_as_before(&owned);
            before++;
        }
        /* The next start. */
        assert_int_equal(iso_components_finish_reset(&config, &times, nowhere, &remark, &fault),
                         begun ? 1 : 0);
        if (begun || ended) {
            expect_reset(&owned);
        } else {
            expect_as_before(&owned);
        }
        if (!killed) {
            assert_true(ended);
            break;
        }
    }
    print_message("killed before each of %d calls, %d of them before the reset had begun\n", kills,
                  before);
    assert_true(before >= 2 && kills > 20);
    mix_let_go(&owned.files);
}

static void a_running_daemon_is_not_reset(void **state)
{
    struct owned owned;
    struct iso_fault fault = {.text = ""};
    begin(*state, &owned);
    const struct iso_config config = config_of(&owned);
    struct iso_components *components = state_rig_open(owned.state);
    assert_int_equal(iso_components_reset(&config, nowhere, &fault), -EBUSY);
    assert_non_null(strstr(fault.text, "stop it first"));
    assert_false(scratch_exists(scratch_path(owned.state, "factory-reset")));
    state_rig_close(components);
    assert_int_equal(state_rig_try(owned.state, &fault), 0);
    mix_let_go(&owned.files);
}

static void without_a_marker_and_a_button_a_start_changes_nothing(void **state)
{
    const struct iso_times times = iso_times_system();
    struct owned owned;
    struct iso_fault remark = {.text = ""}, fault = {.text = ""};
    begin(*state, &owned);
    struct iso_config config = config_of(&owned);
    assert_int_equal(iso_components_finish_reset(&config, &times, nowhere, &remark, &fault), 0);
    assert_string_equal(remark.text, "");
    expect_as_before(&owned);
    /* A button that cannot be read is not held. */
    (void)snprintf(config.reset.button, sizeof config.reset.button, "gpiochip4711:5");
    assert_int_equal(iso_components_finish_reset(&config, &times, nowhere, &remark, &fault), 0);
    assert_string_not_equal(remark.text, "");
    expect_as_before(&owned);
    mix_let_go(&owned.files);
}

#ifdef ISOTHERM_WITH_GPIOD
/* A clock on which each look takes a second, so that the test does not hold a button for ten. */
static int64_t pass_a_second(void *context)
{
    *(int64_t *)context += ISO_NS_PER_S;
    return *(const int64_t *)context;
}

/* The second start finds the button held, too, and nothing to reset: it goes on. */
static void a_button_that_is_held_resets_once(void **state)
{
    static int64_t now_ns;
    const struct iso_times times = {.monotonic = {pass_a_second, &now_ns}};
    struct owned owned;
    struct iso_fault remark = {.text = ""}, fault = {.text = ""};
    begin(*state, &owned);
    struct iso_config config = config_of(&owned);
    (void)snprintf(config.reset.button, sizeof config.reset.button, "fake:5");
    fake_gpio_reset(&now_ns);
    assert_int_equal(iso_components_finish_reset(&config, &times, nowhere, &remark, &fault), 0);
    expect_as_before(&owned);
    fake_gpio_drive(5, true);
    assert_int_equal(iso_components_finish_reset(&config, &times, nowhere, &remark, &fault), 1);
    assert_int_equal(iso_components_finish_reset(&config, &times, nowhere, &remark, &fault), 0);
    expect_reset(&owned);
    assert_int_equal(iso_components_finish_reset(&config, &times, nowhere, &remark, &fault), 1);
    assert_string_equal(remark.text, "");
    assert_int_equal(fake_gpio_open(), 0);
    mix_let_go(&owned.files);
}
#endif

/* A folder that does not let anything be deleted keeps the marker, so the door stays closed. */
static void a_reset_that_fails_can_be_repeated(void **state)
{
    struct owned owned;
    struct iso_fault fault = {.text = ""};
    begin(*state, &owned);
    struct iso_config config = config_of(&owned);
    (void)snprintf(config.reset.link, sizeof config.reset.link, "/proc/self/task");
    assert_true(iso_components_reset(&config, nowhere, &fault) < 0);
    assert_non_null(strstr(fault.text, "/proc/self/task"));
    assert_int_equal(state_rig_try(owned.state, &fault), -EBUSY);
    config = config_of(&owned);
    assert_int_equal(iso_components_reset(&config, nowhere, &fault), 0);
    expect_reset(&owned);
    mix_let_go(&owned.files);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_reset_that_is_killed_at_any_call_is_finished_or_was_never_begun),
        TEST(a_running_daemon_is_not_reset),
        TEST(without_a_marker_and_a_button_a_start_changes_nothing),
        TEST(a_reset_that_fails_can_be_repeated),
#ifdef ISOTHERM_WITH_GPIOD
        TEST(a_button_that_is_held_resets_once),
#endif
    };
    nowhere = fopen("/dev/null", "w");
    return nowhere ? cmocka_run_group_tests(tests, NULL, NULL) : 1;
}
