/* The card reader of the door. */
#include <errno.h>

#include <string.h>

#include "drivers/door/gpio_line.h"
#include "drivers/reader/osdp_reader_port.h"
#include "drivers/reader/wiegand_in.h"
#include "firmware/daemon/components.h"
#include "firmware/daemon/reader_key.h"

/* ---- over OSDP ---- */

/* Reads what the reader has in common with the configuration. The caller wipes *setup. */
static int make_setup(const struct iso_config *config, struct iso_osdp_reader_setup *setup,
                      struct iso_fault *fault)
{
    const struct iso_config_reader *reader = &config->reader;
    *setup = (struct iso_osdp_reader_setup){
        .address = (uint8_t)reader->osdp_address,
        .baud = iso_config_reader_baud(config),
        .has_key = *reader->osdp_key,
    };
    return setup->has_key ? iso_reader_key_read(reader->osdp_key, 0, setup->key, fault) : 0;
}

static int check_osdp(const struct iso_config *config, struct iso_fault *fault)
{
    struct iso_osdp_reader_setup setup;
    const int error = make_setup(config, &setup, fault);
    explicit_bzero(&setup, sizeof setup);
    return error;
}

static int open_osdp(struct iso_components *components, struct iso_fault *fault)
{
    const struct iso_config *config = &components->config;
    struct iso_osdp_reader_setup setup;
    struct iso_fault why = {.text = ""};
    int error = make_setup(config, &setup, fault);
    if (!error) {
        /* A line that is not there now may come later; its fault is in the status. */
        error = iso_osdp_reader_port_new(config->reader.osdp_port, &setup,
                                         &components->times.monotonic, &components->osdp_reader,
                                         &why);
        error = error ? iso_fault_set_code(fault, why.code, error, "%s", why.text) : 0;
    }
    explicit_bzero(&setup, sizeof setup);
    return error;
}

static bool take_osdp(void *context, struct iso_reader_event *out)
{
    return iso_osdp_reader_port_take(context, out);
}

static void copy_osdp_fault(void *context, struct iso_fault *out)
{
    iso_osdp_reader_port_fault(context, out);
}

static int osdp_descriptor(void *context)
{
    return iso_osdp_reader_port_fd(context);
}

static void show_osdp(void *context, bool allow)
{
    iso_osdp_reader_port_show(context, allow);
}

/* ---- on Wiegand lines ---- */

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

static int check_wiegand(const struct iso_config *config, struct iso_fault *fault)
{
    struct iso_gpio_spec lines[2];
    bool wanted;
    return parse_lines(config, lines, &wanted, fault);
}

static int open_wiegand(struct iso_components *components, struct iso_fault *fault)
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
               ? iso_fault_set_code(fault, why.code, -EAGAIN, "%s", why.text)
               : 0;
}

static void close_wiegand(struct iso_components *components)
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

static struct iso_card_source lend_wiegand(const struct iso_components *components)
{
    return components->reader ? (struct iso_card_source){.take = take,
                                                         .fault = copy_fault,
                                                         .fd = descriptor,
                                                         .context = components->reader}
                              : (struct iso_card_source){.take = NULL};
}

#else /* without libgpiod there are no lines */

static int check_wiegand(const struct iso_config *config, struct iso_fault *fault)
{
    struct iso_gpio_spec lines[2];
    bool wanted;
    const int error = parse_lines(config, lines, &wanted, fault);
    return error || !wanted ? error
                            : iso_fault_set(fault, -ENOENT,
                                            "[reader] d0: this daemon was built without libgpiod");
}

static int open_wiegand(struct iso_components *components, struct iso_fault *fault)
{
    return check_wiegand(&components->config, fault);
}

static void close_wiegand(struct iso_components *components)
{
    (void)components;
}

static struct iso_card_source lend_wiegand(const struct iso_components *components)
{
    (void)components;
    return (struct iso_card_source){.take = NULL};
}

#endif

/* ---- either of them ---- */

int iso_components_check_reader(const struct iso_config *config, struct iso_fault *fault)
{
    return *config->reader.osdp_port ? check_osdp(config, fault) : check_wiegand(config, fault);
}

int iso_components_open_reader(struct iso_components *components, struct iso_fault *fault)
{
    return *components->config.reader.osdp_port ? open_osdp(components, fault)
                                                : open_wiegand(components, fault);
}

void iso_components_close_reader(struct iso_components *components)
{
    iso_osdp_reader_port_free(components->osdp_reader);
    close_wiegand(components);
}

struct iso_card_source iso_components_card_source(const struct iso_components *components)
{
    return components->osdp_reader ? (struct iso_card_source){.take = take_osdp,
                                                              .fault = copy_osdp_fault,
                                                              .fd = osdp_descriptor,
                                                              .show = show_osdp,
                                                              .context = components->osdp_reader}
                                   : lend_wiegand(components);
}
