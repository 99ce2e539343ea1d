/* Which keys of the configuration can be changed while the daemon runs, and a change of one of
 * them. Pure.
 *
 * These are the keys that only numbers depend on: times of the door, the decision, learning, the
 * lock-out, motion, hints and enrolment. A key that names a file or a device, that fits wires and
 * locks of the door, or that parts are built with (the sensor, the recognition method, the stores)
 * takes effect at a restart only, and is not one of them. */
#ifndef ISO_FIRMWARE_SETTINGS_LIVE_KEYS_H
#define ISO_FIRMWARE_SETTINGS_LIVE_KEYS_H

#include <stdbool.h>
#include <stddef.h>

#include "firmware/config/config.h"

enum {
    ISO_LIVE_KEYS_MAX = 64,
    ISO_LIVE_VALUE_SIZE = 32, /* of every value of such a key, with the NUL */
};

/* The number of these keys, and the key of an index below it, in the order of iso_config_keys. */
size_t iso_live_keys_count(void);
const struct iso_config_key *iso_live_key_at(size_t index);

/* The key of this section and name if it can be changed; else NULL. */
const struct iso_config_key *iso_live_key_find(const char *section, const char *name);

/* The key of this section and name. -EINVAL with a fault that says whether there is no such key, or
 * that it cannot be changed while the daemon runs. */
int iso_live_key_need(const char *section, const char *name, const struct iso_config_key **out,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* Sets a key to a value in the form of the file, and compares it with the other keys, as the parser
 * of the file does. -EINVAL with the fault of the parser; *config is unchanged then. */
int iso_live_key_set(struct iso_config *config, const struct iso_config_key *key, const char *value,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* The value of a key in the form of the file. */
void iso_live_key_print(const struct iso_config *config, const struct iso_config_key *key,
                        char value[ISO_LIVE_VALUE_SIZE]);

#endif
