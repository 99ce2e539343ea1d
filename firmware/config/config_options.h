/* The keys of [sensor] and [door] that are options of a back end. Internal to firmware/config. The
 * line that names the back end may come after the options, so the parser collects them first and
 * checks them at the end of the file. */
#ifndef ISO_FIRMWARE_CONFIG_CONFIG_OPTIONS_H
#define ISO_FIRMWARE_CONFIG_CONFIG_OPTIONS_H

#include "firmware/config/config.h"

enum { ISO_CONFIG_PENDING_MAX = 48 };

/* The keys of one section that belong to a back end. */
struct iso__config_pending {
    size_t n;
    struct iso__config_line {
        char name[64], value[ISO_CONFIG_TEXT_SIZE];
        int line;
    } list[ISO_CONFIG_PENDING_MAX];
};

/* A section whose key `backend` names a back end of a registry. */
struct iso__config_class {
    const char *section;
    const char *(*registered)(size_t i);
    const struct iso_option_spec *(*options)(const char *back_end);
};

extern const struct iso__config_class iso__config_sensor_class, iso__config_door_class;

/* Notes a key. -EINVAL with a fault: it was noted before, it or its value is too long, or there are
 * too many. */
int iso__config_pending_add(struct iso__config_pending *pending, const char *name,
                            const char *value, int line, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Checks the collected keys against the options of the back end of this name, and adds those with a
 * value to *out. -EINVAL with a fault; *line is then the number of the wrong line. A back end that
 * is not in the registry is not a fault here, because opening it reports the existing ones. */
int iso__config_pending_resolve(const struct iso__config_class *class, const char *back_end,
                                const struct iso__config_pending *pending,
                                struct iso_config_options *out, int *line, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes the options of every back end of the class in the form of the sample file. */
void iso__config_print_options(const struct iso__config_class *class, FILE *out);

#endif
