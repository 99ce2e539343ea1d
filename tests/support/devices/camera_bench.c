#include "tests/support/devices/camera_bench.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "tests/support/scratch.h"

static const char file_driver[] = ISOTHERM_BINARY_DIR
    "/tests/openni2/runtime/OpenNI2/Drivers/libOniFile.so.0";

int camera_bench_make(const char *directory, const char *recording, bool shutter)
{
    size_t size;
    /* Keeps the driver in memory, so that the leak sanitizer can name the functions of its leaks.
     */
    (void)dlopen(file_driver, RTLD_NOW | RTLD_NODELETE);
    scratch_mkdir(directory);
    char *ini = scratch_read(scratch_path(recording, "recording.ini"), &size);
    scratch_write(scratch_path(directory, "camera.ini"), ini, size);
    free(ini);
    assert_int_equal(symlink(recording, scratch_path(directory, "slot")), 0);
    assert_int_equal(setenv("ISOTHERM_BENCH", directory, 1), 0);
    if (!shutter) {
        return -1;
    }
    assert_int_equal(mkfifo(scratch_path(directory, "shutter"), 0600), 0);
    /* Opened for reading, too: then open() does not wait for the camera. */
    const int fd = open(scratch_path(directory, "shutter"), O_RDWR | O_CLOEXEC);
    assert_true(fd >= 0);
    return fd;
}

void camera_bench_press(int shutter_fd)
{
    assert_int_equal(write(shutter_fd, "f", 1), 1);
}

void camera_bench_lose(int shutter_fd)
{
    assert_int_equal(write(shutter_fd, "s", 1), 1);
}

void camera_bench_plug(const char *directory, bool in)
{
    const char *unplugged = scratch_path(directory, "unplugged");
    if (in) {
        assert_int_equal(unlink(unplugged), 0);
    } else {
        scratch_write_text(unplugged, "");
    }
}

void camera_bench_leave(int shutter_fd)
{
    if (shutter_fd >= 0) {
        close(shutter_fd);
    }
    (void)unsetenv("ISOTHERM_BENCH");
}
