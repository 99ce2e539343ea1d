/* Functions that open files: they refuse everything that is no regular file, and they never wait.
 */
#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/file/file.h"
#include "tests/support/scratch.h"

/* Asserts that each function that opens a file returns `error`, and that the text of the fault
 * contains `words`. */
static void expect_refusal(const char *path, int error, const char *words)
{
    struct iso_fault fault = {.text = ""};
    FILE *stream = NULL;
    char *bytes = NULL;
    size_t size = 7;
    int fd = -1;
    (void)alarm(10); /* opening a FIFO would wait for ever */
    assert_int_equal(iso_file_check(path, 100, &fault), error);
    assert_non_null(strstr(fault.text, words));
    for (int i = 0; i < 3; i++) {
        static const int flags[] = {O_RDONLY, O_RDWR, O_WRONLY | O_CREAT | O_TRUNC};
        fault.text[0] = '\0';
        assert_int_equal(iso_file_open(path, flags[i], 100, &fd, &fault), error);
        assert_non_null(strstr(fault.text, words));
        assert_int_equal(fd, -1);
    }
    assert_int_equal(iso_file_stream(path, 100, &stream, NULL), error);
    assert_null(stream);
    assert_int_equal(iso_file_read(path, 100, &bytes, &size, NULL), error);
    assert_null(bytes);
    assert_int_equal(size, 7);
    (void)alarm(0);
}

static void refuses_a_fifo(void **state)
{
    const char *path = scratch_path(*state, "x");
    assert_int_equal(mkfifo(path, 0600), 0);
    expect_refusal(path, -EMEDIUMTYPE, "/x: is a FIFO, not a file");
}

static void refuses_a_directory(void **state)
{
    expect_refusal(*state, -EISDIR, ": is a directory, not a file");
}

static void refuses_a_symbolic_link(void **state)
{
    const char *path = scratch_path(*state, "x"), *file = scratch_path(*state, "file");
    scratch_write_text(file, "text");
    assert_int_equal(symlink(file, path), 0);
    expect_refusal(path, -ELOOP, "/x: is a symbolic link, not a file");
}

static void refuses_a_socket(void **state)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    const char *path = scratch_path(*state, "x");
    const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s", path);
    assert_int_equal(bind(fd, (const struct sockaddr *)&address, sizeof address), 0);
    expect_refusal(path, -EMEDIUMTYPE, "/x: is a socket, not a file");
    (void)close(fd);
}

static void refuses_a_device(void **state)
{
    (void)state;
    expect_refusal("/dev/zero", -EMEDIUMTYPE, "/dev/zero: is a device, not a file");
}

static void refuses_a_longer_file(void **state)
{
    const char *path = scratch_path(*state, "x");
    struct iso_fault fault = {.text = ""};
    char *bytes = NULL;
    size_t size = 0;
    int fd = -1;
    scratch_write_text(path, "");
    assert_int_equal(truncate(path, (off_t)8 << 30), 0);
    assert_int_equal(iso_file_check(path, 100, NULL), -EFBIG);
    assert_int_equal(iso_file_open(path, O_RDWR, 100, &fd, NULL), -EFBIG);
    assert_int_equal(iso_file_read(path, 100, &bytes, &size, &fault), -EFBIG);
    assert_non_null(strstr(fault.text, "/x: longer than 100 bytes"));
    assert_int_equal(iso_file_open(path, O_RDWR, ISO_FILE_ANY_SIZE, &fd, NULL), 0);
    (void)close(fd);
    /* A file that is truncated at the opening may have any length before. */
    assert_int_equal(iso_file_open(path, O_WRONLY | O_TRUNC, 100, &fd, NULL), 0);
    (void)close(fd);
}

static void says_what_open_says(void **state)
{
    struct iso_fault fault = {.text = ""};
    int fd = -1;
    const char *path = scratch_path(*state, "none");
    assert_int_equal(iso_file_check(path, 1, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "/none: No such file"));
    assert_int_equal(iso_file_open(path, O_RDONLY, 1, &fd, &fault), -ENOENT);
    assert_int_equal(iso_file_open(path, O_WRONLY | O_CREAT, 1, &fd, NULL), 0);
    (void)close(fd);
    assert_int_equal(iso_file_open(path, O_WRONLY | O_CREAT | O_EXCL, 1, &fd, NULL), -EEXIST);
    assert_int_equal(iso_file_open(scratch_path(*state, "none/x"), O_RDONLY, 1, &fd, NULL),
                     -ENOTDIR);
}

static void makes_files_for_the_owner_alone(void **state)
{
    const char *path = scratch_path(*state, "x");
    struct stat status;
    int fd = -1;
    assert_int_equal(iso_file_open(path, O_WRONLY | O_CREAT, 1, &fd, NULL), 0);
    assert_int_equal(fstat(fd, &status), 0);
    assert_int_equal(status.st_mode & 07777, 0600);
    assert_true(fcntl(fd, F_GETFD) & FD_CLOEXEC);
    (void)close(fd);
}

/* Directories on the path may be links: /var/lib/isotherm is a link for a service with a dynamic
 * user. */
static void follows_links_to_directories(void **state)
{
    const char *path = scratch_path(*state, "link/file");
    char *bytes = NULL;
    size_t size = 0;
    scratch_mkdir(scratch_path(*state, "directory"));
    scratch_write_text(scratch_path(*state, "directory/file"), "text");
    assert_int_equal(symlink("directory", scratch_path(*state, "link")), 0);
    assert_int_equal(iso_file_read(path, 4, &bytes, &size, NULL), 0);
    assert_int_equal(size, 4);
    assert_string_equal(bytes, "text");
    free(bytes);
}

/* The status of these files has the size 0. */
static void reads_files_whose_size_is_unknown(void **state)
{
    char *bytes = NULL;
    size_t size = 0;
    (void)state;
    assert_int_equal(iso_file_read("/proc/self/status", 1 << 20, &bytes, &size, NULL), 0);
    assert_true(size > 100 && strlen(bytes) == size);
    free(bytes);
    bytes = NULL;
    assert_int_equal(iso_file_read("/proc/self/status", 100, &bytes, &size, NULL), -EFBIG);
    assert_null(bytes);
}

/* Another user has put something at the path of the new file: a second name of the gallery, or a
 * file that everybody may write. */
static void a_new_file_belongs_to_its_owner_alone(void **state)
{
    const char *needed = scratch_path(*state, "needed"), *path = scratch_path(*state, "x.new");
    struct stat status;
    size_t size = 0;
    scratch_write_text(needed, "people");
    assert_int_equal(link(needed, path), 0);
    assert_int_equal(chmod(needed, 0666), 0);
    for (int i = 0; i < 2; i++) { /* over a second name, and over a separate file */
        int fd = -1;
        assert_int_equal(
            iso_file_open(path, O_WRONLY | O_CREAT | O_TRUNC, ISO_FILE_ANY_SIZE, &fd, NULL), 0);
        assert_int_equal(fstat(fd, &status), 0);
        assert_int_equal(status.st_size, 0);
        assert_int_equal(status.st_nlink, 1);
        assert_int_equal(status.st_mode & 0777, 0600);
        assert_int_equal(write(fd, "new", 3), 3);
        assert_int_equal(close(fd), 0);
        assert_int_equal(chmod(path, 0666), 0);
    }
    char *bytes = scratch_read(needed, &size);
    assert_int_equal(size, 6);
    assert_memory_equal(bytes, "people", 6);
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#define IN_SCRATCH(test) cmocka_unit_test_setup_teardown(test, scratch_setup, scratch_teardown)
        IN_SCRATCH(refuses_a_fifo),
        IN_SCRATCH(refuses_a_directory),
        IN_SCRATCH(refuses_a_symbolic_link),
        IN_SCRATCH(refuses_a_socket),
        cmocka_unit_test(refuses_a_device),
        IN_SCRATCH(a_new_file_belongs_to_its_owner_alone),
        IN_SCRATCH(refuses_a_longer_file),
        IN_SCRATCH(says_what_open_says),
        IN_SCRATCH(makes_files_for_the_owner_alone),
        IN_SCRATCH(follows_links_to_directories),
        cmocka_unit_test(reads_files_whose_size_is_unknown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
