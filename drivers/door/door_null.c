#include "drivers/door/door_null.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "drivers/file/text.h"

static const char owner[] = "door null";

static const struct iso_option_spec option_specs[] = {
    {.name = "inputs",
     .kind = ISO_OPTION_PATH,
     .standard = "",
     .help = "a file with the levels of the inputs; all are inactive if empty"},
    {.name = NULL},
};

enum { INPUTS_BYTES_MAX = 4096 };

struct null {
    struct iso_clock clock;
    char *inputs_file; /* NULL: a test injects the inputs */
    int event_fd;      /* readable after an injection; -1 if inputs come from a file */
    struct iso_door_outputs outputs;
    struct iso_door_inputs now, pressed; /* pressed: has been active since the last look */
    size_t n_cards;
    struct iso_wiegand_card card; /* the last card sent */
    size_t n_events;
    struct iso_door_null_event events[ISO_DOOR_NULL_HISTORY]; /* a ring buffer */
};

static void null_close(void *self)
{
    struct null *null = self;
    if (null->event_fd >= 0) {
        (void)close(null->event_fd);
    }
    free(null->inputs_file);
    free(null);
}

/* Inputs come from the file if one is given. Otherwise they are injected, and the event descriptor
 * signals an injection. */
static int connect_inputs(struct null *null, const char *file, struct iso_fault *fault)
{
    if (*file) {
        null->inputs_file = strdup(file);
        return null->inputs_file ? 0 : iso_fault_set(fault, -ENOMEM, "%s: out of memory", owner);
    }
    null->event_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    return null->event_fd >= 0 ? 0 : iso_fault_set(fault, -EIO, "%s: %m", owner);
}

static int null_open(const struct iso_option *options, size_t n_options,
                     const struct iso_clock *clock, const struct iso_door_outputs *initial,
                     void **self, struct iso_fault *fault)
{
    struct null *null = calloc(1, sizeof *null);
    if (!null) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", owner);
    }
    null->clock = *clock;
    null->outputs = *initial;
    null->event_fd = -1;
    const struct iso_option_set set = {option_specs, options, n_options};
    const int error = connect_inputs(null, iso_option_text(&set, "inputs"), fault);
    if (error) {
        null_close(null);
        return error;
    }
    *self = null;
    return 0;
}

static int null_set_output(void *self, enum iso_door_output output, bool active,
                           struct iso_fault *fault)
{
    struct null *null = self;
    (void)fault;
    null->outputs.active[output] = active;
    null->events[null->n_events % ISO_DOOR_NULL_HISTORY] = (struct iso_door_null_event){
        .t_ns = iso_clock_now_ns(&null->clock),
        .output = output,
        .active = active,
    };
    null->n_events++;
    return 0;
}

static int null_send_card(void *self, const struct iso_wiegand_card *card, struct iso_fault *fault)
{
    struct null *null = self;
    uint64_t code;
    if (iso_wiegand_encode(34, card, &code)) {
        return iso_fault_set(fault, -ERANGE, "%s: no card has the number %u:%u", owner,
                             card->facility, card->number);
    }
    null->card = *card;
    null->n_cards++;
    return 0;
}

/* ---- inputs ----------------------------------------------------------------- */

static int input_of(const char *name)
{
    for (int i = 0; i < ISO_DOOR_INPUTS; i++) {
        if (strcmp(iso_door_input_name((enum iso_door_input)i), name) == 0) {
            return i;
        }
    }
    return -1;
}

/* Reads "NAME = 0" or "NAME = 1" with single blanks. Returns NULL, or what is wrong with the
 * line. */
static const char *parse_line(char *line, struct iso_door_inputs *inputs, unsigned *seen)
{
    char *word[3];
    if (iso_text_split(line, ' ', word, 3) != 3 || strcmp(word[1], "=") != 0 ||
        (strcmp(word[2], "0") != 0 && strcmp(word[2], "1") != 0)) {
        return "not `NAME = 0` or `NAME = 1`";
    }
    const int input = input_of(word[0]);
    if (input < 0) {
        return "unknown input";
    }
    if (*seen & 1u << input) {
        return "input given twice";
    }
    *seen |= 1u << input;
    inputs->active[input] = *word[2] == '1';
    return NULL;
}

static int parse_inputs(const char *path, char *text, struct iso_door_inputs *out,
                        struct iso_fault *fault)
{
    struct iso_text_lines lines = iso_text_lines_of(text);
    struct iso_door_inputs inputs = {{false}};
    unsigned seen = 0;
    for (char *line; (line = iso_text_next_line(&lines));) {
        const char *what = parse_line(line, &inputs, &seen);
        if (what) {
            return iso_fault_set(fault, -EBADMSG, "%s:%u: %s", path, lines.number, what);
        }
    }
    for (int i = 0; i < ISO_DOOR_INPUTS; i++) {
        if (!(seen & 1u << i)) {
            return iso_fault_set(fault, -EBADMSG, "%s: input %s is missing", path,
                                 iso_door_input_name((enum iso_door_input)i));
        }
    }
    *out = inputs;
    return 0;
}

static int read_inputs(const char *path, struct iso_door_inputs *out, struct iso_fault *fault)
{
    char *text = NULL;
    int error = iso_text_read(path, INPUTS_BYTES_MAX, &text, fault);
    if (error) {
        return error == -ENOMEM ? error : -EBADMSG;
    }
    error = parse_inputs(path, text, out, fault);
    free(text);
    return error;
}

static int null_get_inputs(void *self, struct iso_door_inputs *out, struct iso_fault *fault)
{
    struct null *null = self;
    uint64_t count;
    if (null->inputs_file) {
        return read_inputs(null->inputs_file, out, fault);
    }
    /* EAGAIN: the descriptor is not readable already. */
    (void)!read(null->event_fd, &count, sizeof count);
    *out = null->now;
    out->active[ISO_DOOR_EXIT_BUTTON] |= null->pressed.active[ISO_DOOR_EXIT_BUTTON];
    out->active[ISO_DOOR_TAMPER] |= null->pressed.active[ISO_DOOR_TAMPER];
    null->pressed = (struct iso_door_inputs){{false}};
    return 0;
}

static int null_poll_fd(void *self)
{
    const struct null *null = self;
    return null->event_fd >= 0 ? null->event_fd : -ENOSYS;
}

const struct iso_door_io_ops iso_door_null_ops = {
    .name = "null",
    .options = option_specs,
    .open = null_open,
    .set_output = null_set_output,
    .get_inputs = null_get_inputs,
    .send_card = null_send_card,
    .poll_fd = null_poll_fd,
    .close = null_close,
};

/* ---- for tests and simulators ----------------------------------------------- */

int iso_door_null_set_input(struct iso_door_io *io, enum iso_door_input input, bool active)
{
    struct null *null = iso_door_io_self(io, &iso_door_null_ops);
    uint64_t one = 1;
    if (!null || null->inputs_file || !iso_door_input_name(input)) {
        return -EINVAL;
    }
    null->now.active[input] = active;
    null->pressed.active[input] |= active;
    return write(null->event_fd, &one, sizeof one) == sizeof one ? 0 : -EIO;
}

int iso_door_null_get_output(struct iso_door_io *io, enum iso_door_output output, bool *active)
{
    const struct null *null = iso_door_io_self(io, &iso_door_null_ops);
    if (!null || !iso_door_output_name(output)) {
        return -EINVAL;
    }
    *active = null->outputs.active[output];
    return 0;
}

int iso_door_null_get_card(struct iso_door_io *io, size_t *count, struct iso_wiegand_card *card)
{
    const struct null *null = iso_door_io_self(io, &iso_door_null_ops);
    if (!null) {
        return -EINVAL;
    }
    *count = null->n_cards;
    if (null->n_cards) {
        *card = null->card;
    }
    return 0;
}

int iso_door_null_event_count(struct iso_door_io *io, size_t *count)
{
    const struct null *null = iso_door_io_self(io, &iso_door_null_ops);
    if (!null) {
        return -EINVAL;
    }
    *count = null->n_events;
    return 0;
}

int iso_door_null_event(struct iso_door_io *io, size_t index, struct iso_door_null_event *out)
{
    const struct null *null = iso_door_io_self(io, &iso_door_null_ops);
    if (!null) {
        return -EINVAL;
    }
    if (index >= null->n_events || null->n_events - index > ISO_DOOR_NULL_HISTORY) {
        return -ENOENT;
    }
    *out = null->events[index % ISO_DOOR_NULL_HISTORY];
    return 0;
}
