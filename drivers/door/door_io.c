#include "drivers/door/door_io.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BACK_END(ops) extern const struct iso_door_io_ops ops;
#include "drivers/door/back_ends.def"
#undef BACK_END

static const struct iso_door_io_ops *const back_ends[] = {
#define BACK_END(ops) &(ops),
#include "drivers/door/back_ends.def"
#undef BACK_END
};

enum { BACK_ENDS = sizeof back_ends / sizeof back_ends[0] };

struct iso_door_io {
    const struct iso_door_io_ops *ops;
    void *self; /* kept while the device is lost; NULL before the first opening */
    bool lost;
    struct iso_clock clock;
    struct iso_option *options; /* copies of the caller's options */
    size_t n_options;
};

const char *iso_door_output_name(enum iso_door_output output)
{
    static const char *const names[ISO_DOOR_OUTPUTS] = {"relay", "led_granted", "led_refused",
                                                        "buzzer", "projector"};
    return (unsigned)output < ISO_DOOR_OUTPUTS ? names[output] : NULL;
}

const char *iso_door_input_name(enum iso_door_input input)
{
    static const char *const names[ISO_DOOR_INPUTS] = {"contact", "exit_button", "tamper"};
    return (unsigned)input < ISO_DOOR_INPUTS ? names[input] : NULL;
}

const char *iso_door_io_registered(size_t i)
{
    return i < BACK_ENDS ? back_ends[i]->name : NULL;
}

static int unknown_back_end(const char *name, struct iso_fault *fault)
{
    char known[128] = "";
    size_t used = 0;
    for (size_t i = 0; i < BACK_ENDS && used < sizeof known; i++) {
        const int length = snprintf(known + used, sizeof known - used, " %s", back_ends[i]->name);
        used += length > 0 ? (size_t)length : 0;
    }
    return iso_fault_set_code(fault, ISO_FAULT_DRIVER_UNKNOWN, -ENOENT,
                              "no door '%s'; there are:%s", name, known);
}

/* ---- open, open anew, close ---- */

static int check_options(const struct iso_door_io_ops *ops, const struct iso_option *options,
                         size_t n_options, struct iso_fault *fault)
{
    const struct iso_option_set set = {ops->options, options, n_options};
    char owner[64];
    (void)snprintf(owner, sizeof owner, "door %s", ops->name);
    const int error = iso_options_check(owner, &set, fault);
    if (error || !ops->check) {
        return error;
    }
    return ops->check(options, n_options, fault);
}

static int copy_options(struct iso_door_io *io, const struct iso_option *options, size_t n_options)
{
    io->options = calloc(n_options + 1, sizeof *io->options);
    for (size_t i = 0; io->options && i < n_options; i++) {
        char *key = strdup(options[i].key);
        char *value = strdup(options[i].value);
        io->options[io->n_options++] = (struct iso_option){key, value};
        if (!key || !value) {
            return -ENOMEM;
        }
    }
    return io->options ? 0 : -ENOMEM;
}

static void free_options(struct iso_door_io *io)
{
    for (size_t i = 0; i < io->n_options; i++) {
        free((char *)io->options[i].key);
        free((char *)io->options[i].value);
    }
    free(io->options);
}

static int new_io(const struct iso_door_io_ops *ops, const struct iso_option *options,
                  size_t n_options, const struct iso_clock *clock, struct iso_door_io **out,
                  struct iso_fault *fault)
{
    const int error = check_options(ops, options, n_options, fault);
    if (error) {
        return error;
    }
    struct iso_door_io *io = calloc(1, sizeof *io);
    if (io) {
        io->ops = ops;
        io->lost = true;
        io->clock = *clock;
    }
    if (!io || copy_options(io, options, n_options)) {
        iso_door_io_close(io);
        return iso_fault_set(fault, -ENOMEM, "door %s: out of memory", ops->name);
    }
    *out = io;
    return 0;
}

static const struct iso_door_io_ops *find_back_end(const char *name)
{
    for (size_t i = 0; i < BACK_ENDS; i++) {
        if (strcmp(back_ends[i]->name, name) == 0) {
            return back_ends[i];
        }
    }
    return NULL;
}

const struct iso_option_spec *iso_door_io_options(const char *name)
{
    const struct iso_door_io_ops *ops = find_back_end(name);
    return ops ? ops->options : NULL;
}

int iso_door_io_check(const char *name, const struct iso_option *options, size_t n_options,
                      struct iso_fault *fault)
{
    const struct iso_door_io_ops *ops = find_back_end(name);
    return ops ? check_options(ops, options, n_options, fault) : unknown_back_end(name, fault);
}

int iso_door_io_new(const char *name, const struct iso_option *options, size_t n_options,
                    const struct iso_clock *clock, struct iso_door_io **out,
                    struct iso_fault *fault)
{
    const struct iso_door_io_ops *ops = find_back_end(name);
    return ops ? new_io(ops, options, n_options, clock, out, fault) : unknown_back_end(name, fault);
}

int iso_door_io_open(const char *name, const struct iso_option *options, size_t n_options,
                     const struct iso_clock *clock, const struct iso_door_outputs *initial,
                     struct iso_door_io **out, struct iso_fault *fault)
{
    const struct iso_door_io_ops *ops = find_back_end(name);
    return ops ? iso_door_io_open_ops(ops, options, n_options, clock, initial, out, fault)
               : unknown_back_end(name, fault);
}

int iso_door_io_open_ops(const struct iso_door_io_ops *ops, const struct iso_option *options,
                         size_t n_options, const struct iso_clock *clock,
                         const struct iso_door_outputs *initial, struct iso_door_io **out,
                         struct iso_fault *fault)
{
    if (!ops->name || !ops->open || !ops->set_output || !ops->get_inputs || !ops->close) {
        return iso_fault_set(fault, -EINVAL, "door %s: a required operation is missing",
                             ops->name ? ops->name : "without a name");
    }
    struct iso_door_io *io = NULL;
    int error = new_io(ops, options, n_options, clock, &io, fault);
    if (!error) {
        error = iso_door_io_reopen(io, initial, fault);
    }
    if (error) {
        iso_door_io_close(io);
        return error;
    }
    *out = io;
    return 0;
}

static void close_device(struct iso_door_io *io)
{
    if (io->self) {
        io->ops->close(io->self);
        io->self = NULL;
    }
}

int iso_door_io_reopen(struct iso_door_io *io, const struct iso_door_outputs *initial,
                       struct iso_fault *fault)
{
    if (!io->lost) {
        return iso_fault_set(fault, -EALREADY, "door %s: is open", io->ops->name);
    }
    close_device(io);
    void *self = NULL;
    const int error = io->ops->open(io->options, io->n_options, &io->clock, initial, &self, fault);
    if (!error) {
        io->self = self;
        io->lost = false;
    }
    return error;
}

void iso_door_io_close(struct iso_door_io *io)
{
    if (io) {
        close_device(io);
        free_options(io);
        free(io);
    }
}

/* ---- operations ---- */

static int device_gone(const struct iso_door_io *io, struct iso_fault *fault)
{
    return iso_fault_set_code(fault, ISO_FAULT_CHIP_GONE, -ENODEV, "door %s: the device is gone",
                              io->ops->name);
}

/* Notes that the device is gone, and makes sure that a failure has a text. */
static int settle_failure(struct iso_door_io *io, int error, const struct iso_fault *reason,
                          struct iso_fault *fault)
{
    if (error == -ENODEV) {
        io->lost = true;
    }
    if (error) {
        const enum iso_fault_code code = error == -ENODEV ? ISO_FAULT_CHIP_GONE
                                                          : ISO_FAULT_LINE_FAILED;
        (void)iso_fault_set_code(fault, reason->code, error, "%s", reason->text);
        if (!reason->text[0]) {
            (void)iso_fault_set(fault, error, "door %s: %s", io->ops->name, strerror(-error));
        }
        (void)iso_fault_code_default(fault, code, error);
    }
    return error;
}

int iso_door_io_set_output(struct iso_door_io *io, enum iso_door_output output, bool active,
                           struct iso_fault *fault)
{
    struct iso_fault reason = {.text = ""};
    if (io->lost) {
        return device_gone(io, fault);
    }
    if (!iso_door_output_name(output)) {
        return iso_fault_set(fault, -EINVAL, "door %s: no output %d", io->ops->name, (int)output);
    }
    const int error = io->ops->set_output(io->self, output, active, &reason);
    return settle_failure(io, error, &reason, fault);
}

int iso_door_io_get_inputs(struct iso_door_io *io, struct iso_door_inputs *out,
                           struct iso_fault *fault)
{
    struct iso_fault reason = {.text = ""};
    if (io->lost) {
        return device_gone(io, fault);
    }
    const int error = io->ops->get_inputs(io->self, out, &reason);
    return settle_failure(io, error, &reason, fault);
}

int iso_door_io_send_card(struct iso_door_io *io, const struct iso_wiegand_card *card,
                          struct iso_fault *fault)
{
    struct iso_fault reason = {.text = ""};
    if (io->lost) {
        return device_gone(io, fault);
    }
    const int error = io->ops->send_card ? io->ops->send_card(io->self, card, &reason) : -ENOSYS;
    return settle_failure(io, error, &reason, fault);
}

int iso_door_io_poll_fd(struct iso_door_io *io)
{
    if (io->lost) {
        return -ENODEV;
    }
    return io->ops->poll_fd ? io->ops->poll_fd(io->self) : -ENOSYS;
}

bool iso_door_io_is_lost(const struct iso_door_io *io)
{
    return io->lost;
}

const char *iso_door_io_name(const struct iso_door_io *io)
{
    return io->ops->name;
}

void *iso_door_io_self(struct iso_door_io *io, const struct iso_door_io_ops *ops)
{
    return io->ops == ops && !io->lost ? io->self : NULL;
}
