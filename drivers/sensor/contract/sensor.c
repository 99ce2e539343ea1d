#include "drivers/sensor/contract/sensor.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct iso_sensor {
    const struct iso_sensor_ops *ops;
    void *self;
    struct iso_clock clock;
    struct iso_sensor_health health;
    bool has_frame; /* a frame came since the start; the next two members describe the last one */
    uint64_t sequence;
    int64_t t_ns;
};

const char *iso_sensor_state_name(enum iso_sensor_state state)
{
    static const char *const names[] = {"open", "started", "lost"};
    return (size_t)state < sizeof names / sizeof *names ? names[state] : NULL;
}

/* ---- failures --------------------------------------------------------------- */

/* Records a failure, passes it to the caller, and sets the state LOST if the device is gone. */
static int fail_call(struct iso_sensor *sensor, int error, const struct iso_fault *reason,
                     struct iso_fault *fault)
{
    struct iso_fault text = *reason;
    if (!text.text[0]) {
        (void)iso_fault_set(&text, error, "sensor %s: %s", sensor->ops->name, strerror(-error));
    }
    (void)iso_fault_code_default(
        &text, error == -ENODEV ? ISO_FAULT_SENSOR_GONE : ISO_FAULT_SENSOR_FAILED, error);
    if (error == -ENODEV) {
        sensor->health.state = ISO_SENSOR_LOST;
    }
    (void)snprintf(sensor->health.last_fault, sizeof sensor->health.last_fault, "%s", text.text);
    return iso_fault_set_code(fault, text.code, error, "%s", text.text);
}

/* Whether the sensor is in `state`, which the call needs: returns 0, -ENODEV or -EBADFD. */
static int require_state(const struct iso_sensor *sensor, enum iso_sensor_state state,
                         struct iso_fault *fault)
{
    if (sensor->health.state == state) {
        return 0;
    }
    if (sensor->health.state == ISO_SENSOR_LOST) {
        return iso_fault_set_code(fault, ISO_FAULT_SENSOR_GONE, -ENODEV,
                                  "sensor %s: the device is gone", sensor->ops->name);
    }
    return iso_fault_set(fault, -EBADFD, "sensor %s: is %s, not %s", sensor->ops->name,
                         iso_sensor_state_name(sensor->health.state), iso_sensor_state_name(state));
}

/* The code for a fault of opening to which the back end gave no code. */
static enum iso_fault_code code_of_opening(int error)
{
    switch (error) {
    case -ENODEV:
        return ISO_FAULT_SENSOR_MISSING;
    case -EACCES:
        return ISO_FAULT_SENSOR_DENIED;
    case -EBUSY:
        return ISO_FAULT_SENSOR_BUSY;
    case -EINVAL:
        return ISO_FAULT_OPTION_WRONG;
    case -EIO:
        return ISO_FAULT_SENSOR_FAILED;
    default:
        return ISO_FAULT_NONE;
    }
}

/* ---- opening and closing ---------------------------------------------------- */

int iso_sensor_check_ops(const struct iso_sensor_ops *ops, const struct iso_option *options,
                         size_t n_options, struct iso_fault *fault)
{
    const struct iso_option_set set = {ops->options, options, n_options};
    char owner[64];
    (void)snprintf(owner, sizeof owner, "sensor %s", ops->name);
    const int error = iso_options_check(owner, &set, fault);
    if (error || !ops->check) {
        return error;
    }
    return ops->check(options, n_options, fault);
}

int iso_sensor_open_ops(const struct iso_sensor_ops *ops, const struct iso_option *options,
                        size_t n_options, const struct iso_clock *clock, struct iso_sensor **out,
                        struct iso_fault *fault)
{
    if (!ops->name || !ops->open || !ops->start || !ops->wait || !ops->stop || !ops->close) {
        return iso_fault_set(fault, -EINVAL, "sensor %s: a required operation is missing",
                             ops->name ? ops->name : "without a name");
    }
    int error = iso_sensor_check_ops(ops, options, n_options, fault);
    if (error) {
        return iso_fault_code_default(fault, code_of_opening(error), error);
    }
    struct iso_sensor *sensor = calloc(1, sizeof *sensor);
    if (!sensor) {
        return iso_fault_set(fault, -ENOMEM, "sensor %s: out of memory", ops->name);
    }
    sensor->ops = ops;
    sensor->clock = *clock;
    error = ops->open(options, n_options, clock, &sensor->self, fault);
    if (error) {
        free(sensor);
        return iso_fault_code_default(fault, code_of_opening(error), error);
    }
    *out = sensor;
    return 0;
}

void iso_sensor_close(struct iso_sensor *sensor)
{
    if (sensor) {
        if (sensor->health.state == ISO_SENSOR_STARTED) {
            (void)sensor->ops->stop(sensor->self);
        }
        sensor->ops->close(sensor->self);
        free(sensor);
    }
}

/* ---- streaming -------------------------------------------------------------- */

int iso_sensor_start(struct iso_sensor *sensor, struct iso_fault *fault)
{
    struct iso_fault reason = {.text = ""};
    int error = require_state(sensor, ISO_SENSOR_OPEN, fault);
    if (error) {
        return error;
    }
    error = sensor->ops->start(sensor->self, &reason);
    if (error) {
        return fail_call(sensor, error, &reason, fault);
    }
    sensor->health.state = ISO_SENSOR_STARTED;
    sensor->has_frame = false;
    return 0;
}

int iso_sensor_stop(struct iso_sensor *sensor, struct iso_fault *fault)
{
    struct iso_fault reason = {.text = ""};
    int error = require_state(sensor, ISO_SENSOR_STARTED, fault);
    if (error) {
        return error;
    }
    sensor->health.state = ISO_SENSOR_OPEN;
    error = sensor->ops->stop(sensor->self);
    return error ? fail_call(sensor, error, &reason, fault) : 0;
}

/* Checks a frame from the back end: -EINVAL with a fault that says what is wrong with it. */
static int check_frame(const struct iso_sensor *sensor, const struct iso_frame *frame,
                       struct iso_fault *flaw)
{
    if (sensor->has_frame && frame->sequence <= sensor->sequence) {
        return iso_fault_set(flaw, -EINVAL, "sequence does not rise");
    }
    if (sensor->has_frame && frame->t_ns <= sensor->t_ns) {
        return iso_fault_set(flaw, -EINVAL, "time does not rise");
    }
    return iso_frame_check(frame, flaw);
}

static void count_frame(struct iso_sensor *sensor, const struct iso_frame *frame)
{
    if (sensor->has_frame) {
        sensor->health.lost += frame->sequence - sensor->sequence - 1;
    }
    sensor->health.frames++;
    sensor->health.last_frame_ns = iso_clock_now_ns(&sensor->clock);
    sensor->has_frame = true;
    sensor->sequence = frame->sequence;
    sensor->t_ns = frame->t_ns;
}

int iso_sensor_wait(struct iso_sensor *sensor, int64_t deadline_ns, const struct iso_frame **frame,
                    struct iso_fault *fault)
{
    struct iso_fault reason = {.text = ""};
    const struct iso_frame *fresh = NULL;
    int error = require_state(sensor, ISO_SENSOR_STARTED, fault);
    if (error) {
        return error;
    }
    error = sensor->ops->wait(sensor->self, deadline_ns, &fresh, &reason);
    if (error == -ETIMEDOUT) {
        return error;
    }
    if (error) {
        sensor->health.faults++;
        return fail_call(sensor, error, &reason, fault);
    }
    struct iso_fault flaw;
    if (check_frame(sensor, fresh, &flaw)) {
        sensor->health.refused++;
        (void)iso_fault_set_code(&reason, ISO_FAULT_SENSOR_FAILED, -EBADMSG,
                                 "sensor %s: frame %llu refused: %s", sensor->ops->name,
                                 (unsigned long long)fresh->sequence, flaw.text);
        return fail_call(sensor, -EBADMSG, &reason, fault);
    }
    count_frame(sensor, fresh);
    *frame = fresh;
    return 0;
}

void iso_sensor_set_interval(struct iso_sensor *sensor, int64_t interval_ns)
{
    if (sensor->health.state == ISO_SENSOR_STARTED && sensor->ops->set_interval) {
        sensor->ops->set_interval(sensor->self, interval_ns);
    }
}

int iso_sensor_next_due_ns(struct iso_sensor *sensor, int64_t *due_ns)
{
    const int error = require_state(sensor, ISO_SENSOR_STARTED, NULL);
    if (error) {
        return error;
    }
    return sensor->ops->next_due_ns ? sensor->ops->next_due_ns(sensor->self, due_ns) : -ENOSYS;
}

/* ---- description and health ---------------------------------------------------- */

int iso_sensor_poll_fd(struct iso_sensor *sensor)
{
    return sensor->ops->poll_fd ? sensor->ops->poll_fd(sensor->self) : -ENOSYS;
}

int iso_sensor_describe(struct iso_sensor *sensor, struct iso_sensor_description *out)
{
    return sensor->ops->describe ? sensor->ops->describe(sensor->self, out) : -ENOSYS;
}

struct iso_sensor_health iso_sensor_health(const struct iso_sensor *sensor)
{
    struct iso_sensor_health health = sensor->health;
    if (sensor->ops->health) {
        sensor->ops->health(sensor->self, &health.device);
    }
    return health;
}

const char *iso_sensor_name(const struct iso_sensor *sensor)
{
    return sensor->ops->name;
}
