#include "firmware/config/config_options.h"

#include <errno.h>
#include <string.h>

#include "drivers/door/door_io.h"
#include "drivers/sensor/contract/sensor.h"

const struct iso__config_class iso__config_sensor_class = {"sensor", iso_sensor_registered,
                                                           iso_sensor_options};
const struct iso__config_class iso__config_door_class = {"door", iso_door_io_registered,
                                                         iso_door_io_options};

int iso__config_pending_add(struct iso__config_pending *pending, const char *name,
                            const char *value, int line, struct iso_fault *fault)
{
    for (size_t i = 0; i < pending->n; i++) {
        if (strcmp(pending->list[i].name, name) == 0) {
            return iso_fault_set(fault, -EINVAL, "'%s' is given twice", name);
        }
    }
    struct iso__config_line *at = &pending->list[pending->n];
    if (pending->n == ISO_CONFIG_PENDING_MAX) {
        return iso_fault_set(fault, -EINVAL, "there are more than %d options of back ends",
                             ISO_CONFIG_PENDING_MAX);
    }
    if (strlen(name) >= sizeof at->name || strlen(value) >= sizeof at->value) {
        return iso_fault_set(fault, -EINVAL, "'%.40s' or its value is too long (%zu bytes)", name,
                             sizeof at->value - 1);
    }
    (void)strcpy(at->name, name);
    (void)strcpy(at->value, value);
    at->line = line;
    pending->n++;
    return 0;
}

/* ---- which back end has an option ---- */

static bool is_registered(const struct iso__config_class *class, const char *back_end)
{
    const char *name;
    for (size_t i = 0; (name = class->registered(i)); i++) {
        if (strcmp(name, back_end) == 0) {
            return true;
        }
    }
    return false;
}

/* The option of a back end that a configuration may have, or NULL. */
static const struct iso_option_spec *find_option(const struct iso__config_class *class,
                                                 const char *back_end, const char *name)
{
    const struct iso_option_spec *spec = iso_option_find_spec(class->options(back_end), name);
    return spec && !spec->tools_only ? spec : NULL;
}

/* Writes the back ends that have an option: "v4l2, openni2", or "". */
static void list_owners(const struct iso__config_class *class, const char *option, char *text,
                        size_t size)
{
    const char *name;
    size_t used = 0;
    text[0] = '\0';
    for (size_t i = 0; (name = class->registered(i)) && used < size; i++) {
        if (find_option(class, name, option)) {
            const int n = snprintf(text + used, size - used, "%s%s", used ? ", " : "", name);
            used += n > 0 ? (size_t)n : 0;
        }
    }
}

/* Handles an option that this back end does not have. An option without a value sets nothing, and
 * is accepted if another back end has it. */
static int refuse_option(const struct iso__config_class *class, const char *back_end,
                         const char *name, const char *value, struct iso_fault *fault)
{
    char owners[128];
    list_owners(class, name, owners, sizeof owners);
    if (!*owners) {
        return iso_fault_set(fault, -EINVAL, "unknown key '%s' in [%s]", name, class->section);
    }
    return *value ? iso_fault_set(fault, -EINVAL,
                                  "the %s %s has no option '%s'; back ends that have it: %s",
                                  class->section, back_end, name, owners)
                  : 0;
}

/* ---- setting ---- */

static int set_option(const struct iso__config_class *class, const char *back_end,
                      struct iso_config_options *out, const struct iso__config_line *given,
                      struct iso_fault *fault)
{
    const struct iso_option_spec *spec = find_option(class, back_end, given->name);
    if (!spec) {
        return refuse_option(class, back_end, given->name, given->value, fault);
    }
    const int error = iso_option_check_value(spec, given->value, fault);
    if (error || !*given->value) {
        return error;
    }
    size_t place = 0;
    while (place < out->n && out->list[place].spec != spec) {
        place++;
    }
    if (place == ISO_CONFIG_OPTIONS_MAX) {
        return iso_fault_set(fault, -EINVAL, "'%s' is one of more than %d options", given->name,
                             ISO_CONFIG_OPTIONS_MAX);
    }
    struct iso_config_option *option = &out->list[place];
    out->n = place < out->n ? out->n : place + 1;
    *option = (struct iso_config_option){.spec = spec, .line = given->line};
    (void)strcpy(option->value, given->value);
    return 0;
}

int iso__config_pending_resolve(const struct iso__config_class *class, const char *back_end,
                                const struct iso__config_pending *pending,
                                struct iso_config_options *out, int *line, struct iso_fault *fault)
{
    if (!is_registered(class, back_end)) {
        return 0;
    }
    for (size_t i = 0; i < pending->n; i++) {
        const int error = set_option(class, back_end, out, &pending->list[i], fault);
        if (error) {
            *line = pending->list[i].line;
            return error;
        }
    }
    return 0;
}

int iso_config_set_sensor_option(struct iso_config *config, const char *name, const char *value,
                                 struct iso_fault *fault)
{
    struct iso__config_pending one = {.n = 0};
    const int error = iso__config_pending_add(&one, name, value, 0, fault);
    return error ? error
                 : set_option(&iso__config_sensor_class, config->sensor.backend,
                              &config->sensor.options, &one.list[0], fault);
}

/* ---- reading ---- */

const char *iso_config_option(const struct iso_config_options *options, const char *name)
{
    for (size_t i = 0; i < options->n; i++) {
        if (strcmp(options->list[i].spec->name, name) == 0) {
            return options->list[i].value;
        }
    }
    return "";
}

static size_t collect_options(const struct iso_config_options *options,
                              struct iso_option out[ISO_CONFIG_OPTIONS_MAX])
{
    for (size_t i = 0; i < options->n; i++) {
        out[i] = (struct iso_option){options->list[i].spec->name, options->list[i].value};
    }
    return options->n;
}

size_t iso_config_sensor_options(const struct iso_config *config,
                                 struct iso_option out[ISO_CONFIG_OPTIONS_MAX])
{
    return collect_options(&config->sensor.options, out);
}

size_t iso_config_door_options(const struct iso_config *config,
                               struct iso_option out[ISO_CONFIG_OPTIONS_MAX])
{
    return collect_options(&config->door.options, out);
}

/* ---- the sample ---- */

static void print_option(const struct iso_option_spec *spec, FILE *out)
{
    char expected[96];
    iso_option_describe(spec, expected, sizeof expected);
    fprintf(out, "# %s", spec->help);
    if (*expected) {
        fprintf(out, " (%s)", expected);
    } else if (spec->required) {
        fputs(" (required)", out);
    }
    const char *standard = spec->required ? "" : spec->standard;
    fprintf(out, "\n#%s =%s%s\n", spec->name, *standard ? " " : "", standard);
}

void iso__config_print_options(const struct iso__config_class *class, FILE *out)
{
    const char *name;
    for (size_t i = 0; (name = class->registered(i)); i++) {
        const struct iso_option_spec *spec = class->options(name);
        fprintf(out, "\n# Options of [%s] with `backend = %s`:\n", class->section, name);
        for (; spec && spec->name; spec++) {
            if (!spec->tools_only) {
                print_option(spec, out);
            }
        }
    }
}
