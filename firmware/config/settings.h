/* The settings that are in force: every key of the appliance and every option of the chosen back
 * ends, with its value, its default, the values that are allowed, and its help. Made from the same
 * tables as the sample file (iso_config_print_sample), so that nothing can be missing. */
#ifndef ISO_FIRMWARE_CONFIG_SETTINGS_H
#define ISO_FIRMWARE_CONFIG_SETTINGS_H

#include "firmware/config/config.h"

/* One setting. The texts are valid while the visitor runs. A text from the configuration file may
 * contain bytes that are not UTF-8. */
struct iso_setting {
    const char *section, *key;
    const char *value;    /* in force, in the form of the file; "": none */
    const char *standard; /* the value that holds if the file does not set the key; "": none */
    const char *range;    /* "a number, 0 to 1", "no|yes"; "required" for a text that a back end
                             needs; "" for other texts */
    const char *help;     /* one line, without a full stop */
};

/* Receives one setting. An error, which is negative, ends the list. */
typedef int (*iso_setting_visitor)(void *context, const struct iso_setting *setting);

/* Passes every setting to the visitor: the keys in the order of the sample file, and after those of
 * [sensor] and [door] the options of the back end that is chosen there. A back end that is not part
 * of this build has none. Returns 0 or the error of the visitor. */
int iso_config_visit_settings(const struct iso_config *config, iso_setting_visitor visit,
                              void *context) __attribute__((warn_unused_result));

#endif
