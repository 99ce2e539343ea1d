#include "drivers/sensor/v4l2/sensor_v4l2_system.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "drivers/base/times.h"

static int kernel_open(void *context, const char *path)
{
    (void)context;
    const int fd = open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return fd < 0 ? -errno : fd;
}

static void kernel_close(void *context, int fd)
{
    (void)context;
    (void)close(fd);
}

static int kernel_ioctl(void *context, int fd, unsigned long request, void *argument)
{
    int result;
    (void)context;
    do {
        result = ioctl(fd, request, argument);
    } while (result < 0 && errno == EINTR);
    return result < 0 ? -errno : 0;
}

static void *kernel_map(void *context, int fd, size_t length, int64_t offset)
{
    (void)context;
    void *at = mmap(NULL, length, PROT_READ, MAP_SHARED, fd, (off_t)offset);
    return at == MAP_FAILED ? NULL : at;
}

static void kernel_unmap(void *context, void *at, size_t length)
{
    (void)context;
    (void)munmap(at, length);
}

static int64_t kernel_monotonic_ns(void *context)
{
    (void)context;
    return iso_monotonic_ns();
}

const struct iso_v4l2_system iso_v4l2_kernel = {
    .open = kernel_open,
    .close = kernel_close,
    .ioctl = kernel_ioctl,
    .map = kernel_map,
    .unmap = kernel_unmap,
    .monotonic_ns = kernel_monotonic_ns,
};
