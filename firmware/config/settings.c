#include "firmware/config/settings.h"

#include <stdio.h>
#include <string.h>

#include "firmware/config/config_options.h"
#include "firmware/config/config_value.h"

/* ---- keys of the appliance ---- */

static int visit_key(const struct iso_config *config, const struct iso_config_key *key,
                     iso_setting_visitor visit, void *context)
{
    char value[ISO_CONFIG_TEXT_SIZE], range[96] = "";
    iso__config_print(key, config, value, sizeof value);
    if (key->type != ISO_CONFIG_TEXT) {
        iso__config_describe(key, range, sizeof range);
    }
    const struct iso_setting setting = {.section = key->section,
                                        .key = key->name,
                                        .value = value,
                                        .standard = key->standard,
                                        .range = range,
                                        .help = key->help};
    return visit(context, &setting);
}

/* ---- options of a back end ---- */

static int visit_option(const char *section, const struct iso_option_spec *spec,
                        const struct iso_config_options *given, iso_setting_visitor visit,
                        void *context)
{
    char range[96];
    const char *standard = spec->required ? "" : spec->standard;
    const char *value = iso_config_option(given, spec->name);
    iso_option_describe(spec, range, sizeof range);
    if (!*range && spec->required) {
        (void)snprintf(range, sizeof range, "required");
    }
    const struct iso_setting setting = {.section = section,
                                        .key = spec->name,
                                        .value = *value ? value : standard,
                                        .standard = standard,
                                        .range = range,
                                        .help = spec->help};
    return visit(context, &setting);
}

/* Visits the options of the back end of a section, if it is a section that has one. */
static int visit_options(const struct iso_config *config, const char *section,
                         iso_setting_visitor visit, void *context)
{
    const struct {
        const struct iso__config_class *class;
        const char *back_end;
        const struct iso_config_options *given;
    } sections[] = {
        {&iso__config_sensor_class, config->sensor.backend, &config->sensor.options},
        {&iso__config_door_class, config->door.backend, &config->door.options},
    };
    int r = 0;
    for (size_t i = 0; i < sizeof sections / sizeof *sections; i++) {
        if (strcmp(section, sections[i].class->section) != 0) {
            continue;
        }
        const struct iso_option_spec *spec = sections[i].class->options(sections[i].back_end);
        for (; r >= 0 && spec && spec->name; spec++) {
            if (!spec->tools_only) {
                r = visit_option(section, spec, sections[i].given, visit, context);
            }
        }
    }
    return r;
}

int iso_config_visit_settings(const struct iso_config *config, iso_setting_visitor visit,
                              void *context)
{
    int r = 0;
    for (size_t i = 0; r >= 0 && i < iso_config_n_keys; i++) {
        const char *section = iso_config_keys[i].section;
        r = visit_key(config, &iso_config_keys[i], visit, context);
        const bool last = i + 1 == iso_config_n_keys ||
                          strcmp(section, iso_config_keys[i + 1].section) != 0;
        if (r >= 0 && last) {
            r = visit_options(config, section, visit, context);
        }
    }
    return r < 0 ? r : 0;
}
