/* The sample of a configuration: every key with its default and its help. */
#include <stdio.h>
#include <string.h>

#include "firmware/config/config_options.h"
#include "firmware/config/config_value.h"

static void print_key(const struct iso_config_key *key, FILE *out)
{
    char expected[96];
    iso__config_describe(key, expected, sizeof expected);
    fprintf(out, "# %s", key->help);
    if (key->type != ISO_CONFIG_TEXT) {
        fprintf(out, " (%s)", expected);
    }
    fprintf(out, "\n#%s =%s%s\n", key->name, *key->standard ? " " : "", key->standard);
}

/* Prints the options of back ends, if the section has any. */
static void print_options(const char *section, FILE *out)
{
    static const struct iso__config_class *const classes[] = {&iso__config_sensor_class,
                                                              &iso__config_door_class};
    for (size_t i = 0; i < sizeof classes / sizeof *classes; i++) {
        if (strcmp(section, classes[i]->section) == 0) {
            iso__config_print_options(classes[i], out);
        }
    }
}

void iso_config_print_sample(FILE *out)
{
    fputs(
        "# Configuration of isothermd, see isotherm.conf(5). Every key is shown with the value "
        "that\n"
        "# holds when it is left out; `isothermd --check-config` says what is wrong with a file.\n",
        out);
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        const char *section = iso_config_keys[i].section;
        if (i == 0 || strcmp(section, iso_config_keys[i - 1].section) != 0) {
            fprintf(out, "\n[%s]\n", section);
        }
        print_key(&iso_config_keys[i], out);
        if (i + 1 == iso_config_n_keys || strcmp(section, iso_config_keys[i + 1].section) != 0) {
            print_options(section, out);
        }
    }
}
