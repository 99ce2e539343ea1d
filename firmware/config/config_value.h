/* Values of the keys of a configuration, as text and as fields. Internal to firmware/config and
 * firmware/settings. */
#ifndef ISO_FIRMWARE_CONFIG_CONFIG_VALUE_H
#define ISO_FIRMWARE_CONFIG_CONFIG_VALUE_H

#include "firmware/config/config.h"

/* Stores the value of a key in its field. -EINVAL: the key does not accept this value. */
int iso__config_store(const struct iso_config_key *key, const char *value,
                      struct iso_config *config);

/* Writes the value of a key in the form of the file: iso__config_store reads the same value back.
 * `size`: ISO_CONFIG_TEXT_SIZE is enough. */
void iso__config_print(const struct iso_config_key *key, const struct iso_config *config,
                       char *text, size_t size);

/* Describes the values that a key accepts. */
void iso__config_describe(const struct iso_config_key *key, char *text, size_t size);

/* Checks keys that are right alone but may contradict each other. Returns what is wrong, or NULL.
 * (config_rules.c) */
const char *iso__config_find_conflict(const struct iso_config *config);

#endif
