#include "drivers/door/door_gpiod.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "drivers/door/debounce.h"
#include "drivers/door/gpio_line.h"
#include "drivers/door/gpiod_options.h"
#include "drivers/door/wiegand_out.h"

static const char owner[] = "door gpiod";

#define NS_PER_S INT64_C(1000000000)

enum { EDGES_MAX = 64 };

struct gpiod {
    struct iso_clock clock;
    struct iso_gpio_line *outputs[ISO_DOOR_OUTPUTS]; /* NULL: the output is not wired */
    struct {
        struct iso_gpio_line *line; /* NULL: the input is not wired */
        struct iso_debounce debounce;
    } inputs[ISO_DOOR_INPUTS];
    struct iso_gpio_line *wiegand[2];    /* D0, D1; only the sender's thread uses them if it runs */
    struct iso_wiegand_out *wiegand_out; /* NULL: the reader lines are not wired */
    int wiegand_bits;
    int timer_fd; /* readable when a level has lasted long enough */
    int epoll_fd; /* readable when the timer or an input is readable */
};

static int gpiod_check(const struct iso_option *options, size_t n_options, struct iso_fault *fault)
{
    struct iso__gpiod_wiring wiring;
    return iso__gpiod_parse_options(options, n_options, &wiring, fault);
}

/* ---- open and close ---- */

static void gpiod_close(void *self)
{
    struct gpiod *gpiod = self;
    iso_wiegand_out_free(gpiod->wiegand_out);
    for (int i = 0; i < 2; i++) {
        iso_gpio_line_close(gpiod->wiegand[i]);
    }
    for (int i = 0; i < ISO_DOOR_OUTPUTS; i++) {
        iso_gpio_line_close(gpiod->outputs[i]);
    }
    for (int i = 0; i < ISO_DOOR_INPUTS; i++) {
        iso_gpio_line_close(gpiod->inputs[i].line);
    }
    if (gpiod->timer_fd >= 0) {
        (void)close(gpiod->timer_fd);
    }
    if (gpiod->epoll_fd >= 0) {
        (void)close(gpiod->epoll_fd);
    }
    free(gpiod);
}

/* Puts the name of the option before the text of a fault. */
static int blame_option(const char *name, int error, const struct iso_fault *reason,
                        struct iso_fault *fault)
{
    return iso_fault_set_code(fault, reason->code, error, "%s: %s: %.200s", owner, name,
                              reason->text);
}

static int claim_outputs(struct gpiod *gpiod, const struct iso__gpiod_wiring *wiring,
                         const struct iso_door_outputs *initial, struct iso_fault *fault)
{
    for (int i = 0; i < ISO_DOOR_OUTPUTS; i++) {
        struct iso_fault reason = {.text = ""};
        int error = 0;
        if (wiring->has_output[i]) {
            error = iso_gpio_line_open_output(&wiring->outputs[i], initial->active[i],
                                              &gpiod->outputs[i], &reason);
        }
        if (error) {
            return blame_option(iso_door_output_name((enum iso_door_output)i), error, &reason,
                                fault);
        }
    }
    return 0;
}

static int claim_input(struct gpiod *gpiod, enum iso_door_input input,
                       const struct iso__gpiod_wiring *wiring, struct iso_fault *reason)
{
    struct iso_gpio_line *line = NULL;
    bool level = false;
    int error = iso_gpio_line_open_input(&wiring->inputs[input], &line, reason);
    if (error) {
        return error;
    }
    struct epoll_event event = {.events = EPOLLIN};
    error = iso_gpio_line_get(line, &level);
    if (!error && epoll_ctl(gpiod->epoll_fd, EPOLL_CTL_ADD, iso_gpio_line_fd(line), &event)) {
        error = errno == ENOMEM ? -ENOMEM : -EIO;
    }
    if (error) {
        iso_gpio_line_close(line);
        return iso_fault_set_code(reason, ISO_FAULT_LINE_FAILED, error, "%s", strerror(-error));
    }
    gpiod->inputs[input].line = line;
    iso_debounce_init(&gpiod->inputs[input].debounce, wiring->debounce_ns, level,
                      iso_clock_now_ns(&gpiod->clock));
    return 0;
}

static int claim_inputs(struct gpiod *gpiod, const struct iso__gpiod_wiring *wiring,
                        struct iso_fault *fault)
{
    struct epoll_event event = {.events = EPOLLIN};
    gpiod->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
    gpiod->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
    if (gpiod->epoll_fd < 0 || gpiod->timer_fd < 0 ||
        epoll_ctl(gpiod->epoll_fd, EPOLL_CTL_ADD, gpiod->timer_fd, &event)) {
        return iso_fault_set(fault, errno == ENOMEM ? -ENOMEM : -EIO, "%s: %m", owner);
    }
    for (int i = 0; i < ISO_DOOR_INPUTS; i++) {
        struct iso_fault reason = {.text = ""};
        const enum iso_door_input input = (enum iso_door_input)i;
        const int error = wiring->has_input[i] ? claim_input(gpiod, input, wiring, &reason) : 0;
        if (error) {
            return blame_option(iso_door_input_name(input), error, &reason, fault);
        }
    }
    return 0;
}

static int set_wiegand(void *context, int line, bool pulse)
{
    struct gpiod *gpiod = context;
    return iso_gpio_line_set(gpiod->wiegand[line], pulse);
}

static int claim_wiegand(struct gpiod *gpiod, const struct iso__gpiod_wiring *wiring,
                         struct iso_fault *fault)
{
    const struct iso_wiegand_lines lines = {set_wiegand, gpiod};
    struct iso_fault reason = {.text = ""};
    if (!wiring->has_wiegand[0]) {
        return 0;
    }
    gpiod->wiegand_bits = wiring->wiegand_bits;
    for (int i = 0; i < 2; i++) {
        const int error = iso_gpio_line_open_output(&wiring->wiegand[i], false, &gpiod->wiegand[i],
                                                    &reason);
        if (error) {
            return blame_option(iso__gpiod_wiegand_names[i], error, &reason, fault);
        }
    }
    return iso_wiegand_out_new(&lines, &gpiod->wiegand_out, fault);
}

static int gpiod_open(const struct iso_option *options, size_t n_options,
                      const struct iso_clock *clock, const struct iso_door_outputs *initial,
                      void **self, struct iso_fault *fault)
{
    struct iso__gpiod_wiring wiring;
    int error = iso__gpiod_parse_options(options, n_options, &wiring, fault);
    if (error) {
        return error;
    }
    struct gpiod *gpiod = calloc(1, sizeof *gpiod);
    if (!gpiod) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", owner);
    }
    gpiod->clock = *clock;
    gpiod->epoll_fd = gpiod->timer_fd = -1;
    error = claim_outputs(gpiod, &wiring, initial, fault);
    if (!error) {
        error = claim_inputs(gpiod, &wiring, fault);
    }
    if (!error) {
        error = claim_wiegand(gpiod, &wiring, fault);
    }
    if (error) {
        gpiod_close(gpiod);
        return error;
    }
    *self = gpiod;
    return 0;
}

/* ---- outputs ---- */

static int gpiod_set_output(void *self, enum iso_door_output output, bool active,
                            struct iso_fault *fault)
{
    struct gpiod *gpiod = self;
    struct iso_gpio_line *line = gpiod->outputs[output];
    const int error = line ? iso_gpio_line_set(line, active) : 0;
    return error ? iso_fault_set_code(fault, iso_gpio_fault_code(error), error, "%s: %s: %s", owner,
                                      iso_door_output_name(output), strerror(-error))
                 : 0;
}

static int gpiod_send_card(void *self, const struct iso_wiegand_card *card, struct iso_fault *fault)
{
    struct gpiod *gpiod = self;
    uint64_t code;
    if (!gpiod->wiegand_out) {
        return iso_fault_set(fault, -ENOSYS, "%s: no controller is wired", owner);
    }
    if (iso_wiegand_encode(gpiod->wiegand_bits, card, &code)) {
        return iso_fault_set(fault, -ERANGE, "%s: %u:%u does not fit in %d bits", owner,
                             card->facility, card->number, gpiod->wiegand_bits);
    }
    const int error = iso_wiegand_out_send(gpiod->wiegand_out, code, gpiod->wiegand_bits);
    return error ? iso_fault_set_code(fault, iso_gpio_fault_code(error), error, "%s: wiegand: %s",
                                      owner, strerror(-error))
                 : 0;
}

/* ---- inputs ---- */

/* Reads the waiting edges and then the level itself, in case the kernel had to drop some edges. If
 * a wire chatters faster than its edges can be read, reading stops after EDGES_MAX of them, because
 * the level would not be more stable later. */
static int follow_input(struct iso_gpio_line *line, struct iso_debounce *debounce, int64_t now_ns)
{
    struct iso_gpio_edge edge;
    bool level;
    int error = 0;
    for (int i = 0; i < EDGES_MAX && (error = iso_gpio_line_next_edge(line, &edge)) == 0; i++) {
        iso_debounce_edge(debounce, edge.active, edge.t_ns);
    }
    if (error == 0 || error == -EAGAIN) {
        error = iso_gpio_line_get(line, &level);
    }
    if (!error) {
        iso_debounce_edge(debounce, level, now_ns);
        iso_debounce_advance(debounce, now_ns);
    }
    return error;
}

/* Makes the descriptor readable when the next level becomes valid; disarms it if no level is
 * pending. Returns -1 and sets errno as timerfd_settime does. */
static int arm_timer(const struct gpiod *gpiod)
{
    int64_t due_ns = INT64_MAX;
    struct itimerspec when = {.it_value.tv_sec = 0};
    for (int i = 0; i < ISO_DOOR_INPUTS; i++) {
        if (gpiod->inputs[i].line) {
            const int64_t its_due_ns = iso_debounce_due_ns(&gpiod->inputs[i].debounce);
            due_ns = its_due_ns < due_ns ? its_due_ns : due_ns;
        }
    }
    if (due_ns != INT64_MAX) {
        when.it_value = (struct timespec){due_ns / NS_PER_S, due_ns % NS_PER_S};
    }
    return timerfd_settime(gpiod->timer_fd, TFD_TIMER_ABSTIME, &when, NULL);
}

static int follow_all(struct gpiod *gpiod, struct iso_fault *fault)
{
    for (int i = 0; i < ISO_DOOR_INPUTS; i++) {
        struct iso_gpio_line *line = gpiod->inputs[i].line;
        const int64_t now_ns = iso_clock_now_ns(&gpiod->clock);
        const int error = line ? follow_input(line, &gpiod->inputs[i].debounce, now_ns) : 0;
        if (error) {
            return iso_fault_set_code(fault, iso_gpio_fault_code(error), error, "%s: %s: %s", owner,
                                      iso_door_input_name((enum iso_door_input)i),
                                      strerror(-error));
        }
    }
    return 0;
}

/* The relay may be on a different chip from the inputs. If that chip is gone, this must be noticed
 * before the next grant, not during it. */
static int look_at_relay(struct gpiod *gpiod, struct iso_fault *fault)
{
    bool active;
    struct iso_gpio_line *relay = gpiod->outputs[ISO_DOOR_RELAY];
    const int error = relay ? iso_gpio_line_get(relay, &active) : 0;
    return error ? iso_fault_set_code(fault, iso_gpio_fault_code(error), error, "%s: relay: %s",
                                      owner, strerror(-error))
                 : 0;
}

static int gpiod_get_inputs(void *self, struct iso_door_inputs *out, struct iso_fault *fault)
{
    struct gpiod *gpiod = self;
    struct iso_door_inputs inputs = {{false}};
    int error = look_at_relay(gpiod, fault);
    if (!error) {
        error = follow_all(gpiod, fault);
    }
    if (error) {
        return error;
    }
    if (arm_timer(gpiod)) {
        return iso_fault_set(fault, -EIO, "%s: timer: %m", owner);
    }
    for (int i = 0; i < ISO_DOOR_INPUTS; i++) {
        struct iso_debounce *debounce = &gpiod->inputs[i].debounce;
        const bool now = debounce->level;
        inputs.active[i] = i == ISO_DOOR_CONTACT ? now : iso_debounce_take(debounce);
    }
    *out = inputs;
    return 0;
}

static int gpiod_poll_fd(void *self)
{
    return ((const struct gpiod *)self)->epoll_fd;
}

const struct iso_door_io_ops iso_door_gpiod_ops = {
    .name = "gpiod",
    .options = iso__gpiod_options,
    .check = gpiod_check,
    .open = gpiod_open,
    .set_output = gpiod_set_output,
    .get_inputs = gpiod_get_inputs,
    .send_card = gpiod_send_card,
    .poll_fd = gpiod_poll_fd,
    .close = gpiod_close,
};
