#include "tests/support/devices/wired_door.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

enum { PATIENCE_S = 60 };

static struct {
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    int fd;
    struct iso_door_inputs now, pressed;
    struct iso_door_outputs outputs;
    unsigned switchings[ISO_DOOR_OUTPUTS];
} door = {.mutex = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER, .fd = -1};

static int wired_check(const struct iso_option *options, size_t n_options, struct iso_fault *fault)
{
    (void)options;
    (void)n_options;
    (void)fault;
    return 0;
}

static int wired_open(const struct iso_option *options, size_t n_options,
                      const struct iso_clock *clock, const struct iso_door_outputs *initial,
                      void **self, struct iso_fault *fault)
{
    (void)options;
    (void)n_options;
    (void)clock;
    (void)fault;
    door.fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    assert_true(door.fd >= 0);
    door.outputs = *initial;
    door.now = door.pressed = (struct iso_door_inputs){{false}};
    for (int i = 0; i < ISO_DOOR_OUTPUTS; i++) {
        door.switchings[i] = 0;
    }
    *self = &door;
    return 0;
}

static int wired_set_output(void *self, enum iso_door_output output, bool active,
                            struct iso_fault *fault)
{
    (void)self;
    (void)fault;
    (void)pthread_mutex_lock(&door.mutex);
    door.switchings[output] += door.outputs.active[output] != active;
    door.outputs.active[output] = active;
    (void)pthread_cond_broadcast(&door.changed);
    (void)pthread_mutex_unlock(&door.mutex);
    return 0;
}

static int wired_get_inputs(void *self, struct iso_door_inputs *out, struct iso_fault *fault)
{
    uint64_t count;
    (void)self;
    (void)fault;
    (void)pthread_mutex_lock(&door.mutex);
    (void)!read(door.fd, &count, sizeof count);
    *out = door.now;
    out->active[ISO_DOOR_EXIT_BUTTON] |= door.pressed.active[ISO_DOOR_EXIT_BUTTON];
    out->active[ISO_DOOR_TAMPER] |= door.pressed.active[ISO_DOOR_TAMPER];
    const bool was_short = door.pressed.active[ISO_DOOR_EXIT_BUTTON] &&
                           !door.now.active[ISO_DOOR_EXIT_BUTTON];
    door.pressed = (struct iso_door_inputs){{false}};
    if (was_short) { /* the next reading finds it released */
        const uint64_t one = 1;
        (void)!write(door.fd, &one, sizeof one);
    }
    (void)pthread_mutex_unlock(&door.mutex);
    return 0;
}

static int wired_poll_fd(void *self)
{
    (void)self;
    return door.fd;
}

static void wired_close(void *self)
{
    (void)self;
    (void)close(door.fd);
    door.fd = -1;
}

const struct iso_door_io_ops wired_door_ops = {
    .name = "wired",
    .check = wired_check,
    .open = wired_open,
    .set_output = wired_set_output,
    .get_inputs = wired_get_inputs,
    .poll_fd = wired_poll_fd,
    .close = wired_close,
};

static int64_t stands_still(void *context)
{
    (void)context;
    return 0;
}

struct iso_door_io *wired_door_open(void)
{
    static const struct iso_door_outputs unpowered;
    const struct iso_clock clock = {stands_still, NULL};
    struct iso_door_io *io = NULL;
    assert_int_equal(iso_door_io_open_ops(&wired_door_ops, NULL, 0, &clock, &unpowered, &io, NULL),
                     0);
    return io;
}

void wired_door_set(enum iso_door_input input, bool active)
{
    const uint64_t one = 1;
    (void)pthread_mutex_lock(&door.mutex);
    door.now.active[input] = active;
    door.pressed.active[input] |= active;
    assert_int_equal(write(door.fd, &one, sizeof one), sizeof one);
    (void)pthread_mutex_unlock(&door.mutex);
}

void wired_door_press(void)
{
    wired_door_set(ISO_DOOR_EXIT_BUTTON, true);
    wired_door_set(ISO_DOOR_EXIT_BUTTON, false);
}

void wired_door_await(enum iso_door_output output, unsigned switchings)
{
    struct timespec until;
    int error = 0;
    (void)clock_gettime(CLOCK_REALTIME, &until);
    until.tv_sec += PATIENCE_S;
    (void)pthread_mutex_lock(&door.mutex);
    while (door.switchings[output] < switchings && error == 0) {
        error = pthread_cond_timedwait(&door.changed, &door.mutex, &until);
    }
    const unsigned switched = door.switchings[output];
    (void)pthread_mutex_unlock(&door.mutex);
    assert_true(switched >= switchings);
}

unsigned wired_door_switchings(enum iso_door_output output)
{
    (void)pthread_mutex_lock(&door.mutex);
    const unsigned switchings = door.switchings[output];
    (void)pthread_mutex_unlock(&door.mutex);
    return switchings;
}

bool wired_door_level(enum iso_door_output output)
{
    (void)pthread_mutex_lock(&door.mutex);
    const bool level = door.outputs.active[output];
    (void)pthread_mutex_unlock(&door.mutex);
    return level;
}
