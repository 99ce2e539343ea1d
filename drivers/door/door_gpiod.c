#include "drivers/door/door_gpiod.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "drivers/door/debounce.h"
#include "drivers/door/gpio_line.h"
#include "drivers/door/wiegand_out.h"

static const char owner[] = "door gpiod";

#define NS_PER_MS INT64_C(1000000)
#define NS_PER_S  INT64_C(1000000000)

enum { EDGES_MAX = 64 };

/* What the options ask for. */
struct wiring {
    bool has_output[ISO_DOOR_OUTPUTS], has_input[ISO_DOOR_INPUTS];
    struct iso_gpio_spec outputs[ISO_DOOR_OUTPUTS], inputs[ISO_DOOR_INPUTS];
    bool has_wiegand[2]; /* D0, D1 */
    struct iso_gpio_spec wiegand[2];
    int wiegand_bits;
    int64_t debounce_ns;
};

struct gpiod {
    struct iso_clock clock;
    struct iso_gpio_line *outputs[ISO_DOOR_OUTPUTS]; /* NULL: not wired */
    struct {
        struct iso_gpio_line *line; /* NULL: not wired */
        struct iso_debounce debounce;
    } inputs[ISO_DOOR_INPUTS];
    struct iso_gpio_line *wiegand[2];    /* D0, D1; the sender's thread's while there is one */
    struct iso_wiegand_out *wiegand_out; /* NULL: not wired */
    int wiegand_bits;
    int timer_fd; /* readable when a level has lasted long enough */
    int epoll_fd; /* readable when that or an input is */
};

/* ---- options ---- */

static int check_line(const char *value, struct iso_fault *fault)
{
    struct iso_gpio_spec spec;
    return iso_gpio_spec_parse(NULL, value, &spec, fault);
}

/* clang-format off */
#define LINE(key, text) \
    {.name = (key), .kind = ISO_OPTION_LINE, .standard = "", .check = check_line, .help = (text)}
/* clang-format on */

static const struct iso_option_spec option_specs[] = {
    LINE("relay", "the line of the lock's relay; not needed with wiegand_d0 and wiegand_d1"),
    LINE("led_granted", "the line of the green light"),
    LINE("led_refused", "the line of the red light"),
    LINE("buzzer", "the line of the buzzer"),
    LINE("projector", "the line of the infrared dot projector"),
    LINE("contact", "the line of the door contact, active when the door stands open"),
    LINE("exit_button", "the line of the exit button, active when it is pressed"),
    LINE("tamper", "the line of the housing's switch, active when the housing is open"),
    LINE("wiegand_d0", "the line D0 to an access controller; active is a pulse"),
    LINE("wiegand_d1", "the line D1 to an access controller; active is a pulse"),
    {.name = "debounce_ms",
     .kind = ISO_OPTION_COUNT,
     .min = 0,
     .max = ISO_DOOR_GPIOD_DEBOUNCE_MAX_MS,
     .standard = "10",
     .help = "how long an input has to keep a level until it counts"},
    {.name = "wiegand_bits",
     .kind = ISO_OPTION_CHOICE,
     .choices = "26|34",
     .standard = "26",
     .help = "the format of the access controller: 26 bits (H10301) or 34 bits (H10306)"},
    {.name = NULL},
};

static int parse_spec(const struct iso_option_set *set, const char *key, bool *there,
                      struct iso_gpio_spec *spec, struct iso_fault *fault)
{
    char name[64];
    *there = iso_option_is_given(set, key);
    if (!*there) {
        return 0;
    }
    (void)snprintf(name, sizeof name, "%s: %s", owner, key);
    return iso_gpio_spec_parse(name, iso_option_text(set, key), spec, fault);
}

static const char *const wiegand_names[2] = {"wiegand_d0", "wiegand_d1"};

static int parse_wiegand(const struct iso_option_set *set, struct wiring *wiring,
                         struct iso_fault *fault)
{
    int error = 0;
    wiring->wiegand_bits = (int)iso_option_number(set, "wiegand_bits");
    for (int i = 0; !error && i < 2; i++) {
        error = parse_spec(set, wiegand_names[i], &wiring->has_wiegand[i], &wiring->wiegand[i],
                           fault);
    }
    if (!error && wiring->has_wiegand[0] != wiring->has_wiegand[1]) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s: option '%s' is missing", owner,
                                  wiegand_names[wiring->has_wiegand[0]]);
    }
    return error;
}

static int parse_options(const struct iso_option *options, size_t n_options, struct wiring *wiring,
                         struct iso_fault *fault)
{
    const struct iso_option_set set = {option_specs, options, n_options};
    int error = 0;
    for (int i = 0; !error && i < ISO_DOOR_OUTPUTS; i++) {
        error = parse_spec(&set, iso_door_output_name((enum iso_door_output)i),
                           &wiring->has_output[i], &wiring->outputs[i], fault);
    }
    for (int i = 0; !error && i < ISO_DOOR_INPUTS; i++) {
        error = parse_spec(&set, iso_door_input_name((enum iso_door_input)i), &wiring->has_input[i],
                           &wiring->inputs[i], fault);
    }
    wiring->debounce_ns = (int64_t)iso_option_number(&set, "debounce_ms") * NS_PER_MS;
    error = error ? error : parse_wiegand(&set, wiring, fault);
    if (!error && !wiring->has_output[ISO_DOOR_RELAY] && !wiring->has_wiegand[0]) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s: option 'relay' is missing", owner);
    }
    return error;
}

static int gpiod_check(const struct iso_option *options, size_t n_options, struct iso_fault *fault)
{
    struct wiring wiring = {.debounce_ns = 0};
    return parse_options(options, n_options, &wiring, fault);
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

/* Puts the name of the option before a fault. */
static int blame(const char *name, int error, const struct iso_fault *reason,
                 struct iso_fault *fault)
{
    return iso_fault_set_code(fault, reason->code, error, "%s: %s: %.200s", owner, name,
                              reason->text);
}

static int claim_outputs(struct gpiod *gpiod, const struct wiring *wiring,
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
            return blame(iso_door_output_name((enum iso_door_output)i), error, &reason, fault);
        }
    }
    return 0;
}

static int claim_input(struct gpiod *gpiod, enum iso_door_input input, const struct wiring *wiring,
                       struct iso_fault *reason)
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

static int claim_inputs(struct gpiod *gpiod, const struct wiring *wiring, struct iso_fault *fault)
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
            return blame(iso_door_input_name(input), error, &reason, fault);
        }
    }
    return 0;
}

static int set_wiegand(void *context, int line, bool pulse)
{
    struct gpiod *gpiod = context;
    return iso_gpio_line_set(gpiod->wiegand[line], pulse);
}

static int claim_wiegand(struct gpiod *gpiod, const struct wiring *wiring, struct iso_fault *fault)
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
            return blame(wiegand_names[i], error, &reason, fault);
        }
    }
    return iso_wiegand_out_new(&lines, &gpiod->wiegand_out, fault);
}

static int gpiod_open(const struct iso_option *options, size_t n_options,
                      const struct iso_clock *clock, const struct iso_door_outputs *initial,
                      void **self, struct iso_fault *fault)
{
    struct wiring wiring = {.debounce_ns = 0};
    int error = parse_options(options, n_options, &wiring, fault);
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

/* The edges that wait, then the level itself, in case the kernel had to drop some. A wire that
 * chatters faster than it is read is left after EDGES_MAX: its level is no steadier later. */
static int follow(struct iso_gpio_line *line, struct iso_debounce *debounce, int64_t now_ns)
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

/* Makes the descriptor readable when the next level counts; quiet if none is under way. -1 and
 * errno as timerfd_settime. */
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
        const int error = line ? follow(line, &gpiod->inputs[i].debounce, now_ns) : 0;
        if (error) {
            return iso_fault_set_code(fault, iso_gpio_fault_code(error), error, "%s: %s: %s", owner,
                                      iso_door_input_name((enum iso_door_input)i),
                                      strerror(-error));
        }
    }
    return 0;
}

/* The relay may be on another chip than the inputs, or there may be none: whether it is still there
 * is not to be found out when somebody has to be let in. */
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
    .options = option_specs,
    .check = gpiod_check,
    .open = gpiod_open,
    .set_output = gpiod_set_output,
    .get_inputs = gpiod_get_inputs,
    .send_card = gpiod_send_card,
    .poll_fd = gpiod_poll_fd,
    .close = gpiod_close,
};
