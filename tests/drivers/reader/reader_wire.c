#include "tests/drivers/reader/reader_wire.h"

#include <fcntl.h>
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cmocka.h>

static uint32_t throw_dice(struct reader_wire *wire, uint32_t sides)
{
    wire->dice = wire->dice * 1664525 + 1013904223;
    return (wire->dice >> 8) % sides;
}

/* Returns how many bytes of a piece arrive. */
static size_t spoil(struct reader_wire *wire, uint8_t *bytes, size_t n)
{
    const unsigned loss = atomic_load(&wire->loss);
    if (loss == 0 || throw_dice(wire, loss) > 0) {
        return n;
    }
    if (loss > 1 && throw_dice(wire, 2) == 0) {
        bytes[throw_dice(wire, (uint32_t)n)] ^= (uint8_t)(1 + throw_dice(wire, 255));
        return n;
    }
    return 0;
}

static void *carry(void *context)
{
    struct reader_wire *wire = context;
    for (;;) {
        struct pollfd waits[3] = {{.fd = wire->end_fd, .events = POLLIN}};
        for (int i = 0; i < 2; i++) {
            waits[1 + i] = (struct pollfd){.fd = wire->masters[i], .events = POLLIN};
        }
        (void)poll(waits, 3, -1);
        if (waits[0].revents) {
            return NULL;
        }
        for (int i = 0; i < 2; i++) {
            uint8_t bytes[256];
            const ssize_t n = waits[1 + i].revents ? read(wire->masters[i], bytes, sizeof bytes)
                                                   : 0;
            const size_t left = n > 0 ? spoil(wire, bytes, (size_t)n) : 0;
            if (left > 0 && wire->masters[1 - i] >= 0) {
                (void)!write(wire->masters[1 - i], bytes, left);
            }
        }
    }
}

static void start(struct reader_wire *wire)
{
    wire->end_fd = eventfd(0, EFD_CLOEXEC);
    assert_true(wire->end_fd >= 0);
    assert_int_equal(pthread_create(&wire->thread, NULL, carry, wire), 0);
}

static void stop(struct reader_wire *wire)
{
    assert_int_equal(eventfd_write(wire->end_fd, 1), 0);
    assert_int_equal(pthread_join(wire->thread, NULL), 0);
    (void)close(wire->end_fd);
}

/* The slave is kept open, so that the master does not end while nobody else has it open. */
static void make_end(struct reader_wire *wire, int end, char path[64])
{
    const int master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    assert_true(master >= 0);
    assert_int_equal(grantpt(master), 0);
    assert_int_equal(unlockpt(master), 0);
    assert_int_equal(ptsname_r(master, path, 64), 0);
    wire->masters[end] = master;
    wire->slaves[end] = open(path, O_RDWR | O_NOCTTY | O_CLOEXEC);
    assert_true(wire->slaves[end] >= 0);
}

static void drop_end(struct reader_wire *wire, int end)
{
    if (wire->masters[end] >= 0) {
        (void)close(wire->slaves[end]);
        (void)close(wire->masters[end]);
        wire->masters[end] = -1;
    }
}

static void make_appliance_end(struct reader_wire *wire)
{
    char path[64];
    make_end(wire, 0, path);
    assert_int_equal(symlink(path, wire->appliance_path), 0);
}

void reader_wire_open(struct reader_wire *wire, const char *directory)
{
    memset(wire, 0, sizeof *wire);
    wire->dice = 99;
    (void)snprintf(wire->appliance_path, sizeof wire->appliance_path, "%s/line", directory);
    make_appliance_end(wire);
    make_end(wire, 1, wire->reader_path);
    start(wire);
}

void reader_wire_close(struct reader_wire *wire)
{
    stop(wire);
    drop_end(wire, 0);
    drop_end(wire, 1);
    (void)unlink(wire->appliance_path);
}

void reader_wire_unplug(struct reader_wire *wire)
{
    stop(wire);
    drop_end(wire, 0);
    assert_int_equal(unlink(wire->appliance_path), 0);
    start(wire);
}

void reader_wire_plug(struct reader_wire *wire)
{
    stop(wire);
    make_appliance_end(wire);
    start(wire);
}
