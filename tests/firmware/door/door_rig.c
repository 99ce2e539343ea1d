#include "tests/firmware/door/door_rig.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_null.h"
#include "tests/support/devices/manual_clock.h"

int64_t door_rig_now_ns;
struct iso_door_io *door_rig_io;
struct iso_door_control door_rig_control;
char door_rig_told[512]; /* "unlocked(grant) ..." */
struct iso_door_outputs door_rig_opened_with;
bool door_rig_weak_contact;
int door_rig_weak_fd;
int door_rig_failing;
const struct iso_door_outputs door_rig_unpowered;
const struct iso_door_options door_rig_options = {.fail = ISO_DOOR_FAIL_SECURE,
                                                  .unlock_ns = 4000 * MS,
                                                  .held_ns = 30000 * MS,
                                                  .refused_ns = 2000 * MS};
const struct iso_door_timing door_rig_timing = {50 * MS, 500 * MS, 1200 * MS};

void door_rig_on_changed(void *context, enum iso_door_event cause)
{
    const size_t used = strlen(door_rig_told);
    assert_ptr_equal(context, &door_rig_control);
    (void)snprintf(door_rig_told + used, sizeof door_rig_told - used, "%s(%s) ",
                   iso_door_state_name(door_rig_control.door.state), iso_door_event_name(cause));
}

/* The reports since the last call. */
const char *door_rig_news(void)
{
    static char text[sizeof door_rig_told];
    strcpy(text, door_rig_told);
    door_rig_told[0] = '\0';
    return text;
}

/* The null back end behind operations that can fail. */
static int weak_open(const struct iso_option *o, size_t n, const struct iso_clock *clock,
                     const struct iso_door_outputs *initial, void **self, struct iso_fault *fault)
{
    if (door_rig_failing) {
        return iso_fault_set(fault, -EBUSY, "the wire is taken");
    }
    door_rig_opened_with = *initial;
    return iso_door_null_ops.open(o, n, clock, initial, self, fault);
}

static int weak_set_output(void *self, enum iso_door_output output, bool active,
                           struct iso_fault *fault)
{
    return door_rig_failing ? iso_fault_set(fault, door_rig_failing, "the wire is cut")
                            : iso_door_null_ops.set_output(self, output, active, fault);
}

static int weak_get_inputs(void *self, struct iso_door_inputs *out, struct iso_fault *fault)
{
    if (door_rig_failing) {
        return iso_fault_set(fault, door_rig_failing, "the wire is cut");
    }
    const int error = iso_door_null_ops.get_inputs(self, out, fault);
    out->active[ISO_DOOR_CONTACT] |= door_rig_weak_contact;
    return error;
}

static int weak_poll_fd(void *self)
{
    (void)self;
    return door_rig_weak_fd ? door_rig_weak_fd : -ENOSYS;
}

static void weak_close(void *self)
{
    iso_door_null_ops.close(self);
}

static const struct iso_door_io_ops weak_ops = {
    .name = "weak",
    .open = weak_open,
    .set_output = weak_set_output,
    .get_inputs = weak_get_inputs,
    .poll_fd = weak_poll_fd,
    .close = weak_close,
};

static void prepare(const struct iso_door_io_ops *ops)
{
    const struct iso_clock clock = manual_clock(&door_rig_now_ns);
    door_rig_now_ns = 1000 * MS;
    door_rig_told[0] = '\0';
    door_rig_failing = 0;
    door_rig_weak_contact = false;
    door_rig_weak_fd = 0;
    assert_int_equal(
        iso_door_io_open_ops(ops, NULL, 0, &clock, &door_rig_unpowered, &door_rig_io, NULL), 0);
    iso_door_control_init(&door_rig_control, &door_rig_options, &door_rig_timing, door_rig_io,
                          door_rig_on_changed, &door_rig_control);
}

int door_rig_setup(void **state)
{
    (void)state;
    prepare(&iso_door_null_ops);
    return 0;
}

int door_rig_setup_weak(void **state)
{
    (void)state;
    prepare(&weak_ops);
    return 0;
}

int door_rig_teardown(void **state)
{
    (void)state;
    iso_door_io_close(door_rig_io);
    return 0;
}

void door_rig_set_input(enum iso_door_input input, bool active)
{
    assert_int_equal(iso_door_null_set_input(door_rig_io, input, active), 0);
}

bool door_rig_output(enum iso_door_output which)
{
    bool active = false;
    assert_int_equal(iso_door_null_get_output(door_rig_io, which, &active), 0);
    return active;
}

void door_rig_step_at(int64_t t_ms)
{
    door_rig_now_ns = t_ms * MS;
    iso_door_control_step(&door_rig_control, false, door_rig_now_ns);
}
