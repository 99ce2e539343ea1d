/* The card reader of the door. */
#include <errno.h>

#include "drivers/door/gpio_line.h"
#include "drivers/reader/wiegand_in.h"
#include "firmware/daemon/components.h"

/* Reads how the two lines are wired. *wanted: whether there is a reader. */
static int parse_lines(const struct iso_config *config, struct iso_gpio_spec lines[2], bool *wanted,
                       struct iso_fault *fault)
{
    const struct iso_config_reader *reader = &config->reader;
    *wanted = *reader->d0 || *reader->d1;
    if (*wanted && (!*reader->d0 || !*reader->d1)) {
        return iso_fault_set(fault, -EINVAL, "[reader] a card reader needs both lines, d0 and d1");
    }
    int error = *wanted ? iso_gpio_spec_parse("[reader] d0", reader->d0, &lines[0], fault) : 0;
    if (!error && *wanted) {
        error = iso_gpio_spec_parse("[reader] d1", reader->d1, &lines[1], fault);
    }
    return error;
}

#ifdef ISOTHERM_WITH_GPIOD

int iso_components_check_reader(const struct iso_config *config, struct iso_fault *fault)
{
    struct iso_gpio_spec lines[2];
    bool wanted;
    return parse_lines(config, lines, &wanted, fault);
}

int iso_components_open_reader(struct iso_components *components, struct iso_fault *fault)
{
    struct iso_gpio_spec lines[2];
    struct iso_fault why = {.text = ""};
    bool wanted;
    const int error = parse_lines(&components->config, lines, &wanted, fault);
    if (error || !wanted) {
        return error;
    }
    /* A reader that is not there now may come later; its fault is in the status. */
    return iso_wiegand_in_new(lines, &components->reader, &why)
               ? iso_fault_set(fault, -EAGAIN, "%s", why.text)
               : 0;
}

void iso_components_close_reader(struct iso_components *components)
{
    iso_wiegand_in_free(components->reader);
}

static bool take(void *context, struct iso_reader_event *out)
{
    return iso_wiegand_in_take(context, out);
}

static void copy_fault(void *context, struct iso_fault *out)
{
    iso_wiegand_in_fault(context, out);
}

static int descriptor(void *context)
{
    return iso_wiegand_in_fd(context);
}

struct iso_card_source iso_components_card_source(const struct iso_components *components)
{
    return components->reader
               ? (struct iso_card_source){take, copy_fault, descriptor, components->reader}
               : (struct iso_card_source){.take = NULL};
}

#else /* without libgpiod there are no lines */

int iso_components_check_reader(const struct iso_config *config, struct iso_fault *fault)
{
    struct iso_gpio_spec lines[2];
    bool wanted;
    const int error = parse_lines(config, lines, &wanted, fault);
    return error || !wanted ? error
                            : iso_fault_set(fault, -ENOENT,
                                            "[reader] d0: this daemon was built without libgpiod");
}

int iso_components_open_reader(struct iso_components *components, struct iso_fault *fault)
{
    return iso_components_check_reader(&components->config, fault);
}

void iso_components_close_reader(struct iso_components *components)
{
    (void)components;
}

struct iso_card_source iso_components_card_source(const struct iso_components *components)
{
    (void)components;
    return (struct iso_card_source){.take = NULL};
}

#endif
