/* Values of the keys of a configuration, as text and as fields. Internal to firmware/config. */
#ifndef ISO_FIRMWARE_CONFIG_CONFIG_VALUE_H
#define ISO_FIRMWARE_CONFIG_CONFIG_VALUE_H

#include "firmware/config/config.h"

/* Puts the value of a key into its field. -EINVAL: it is none for this key. */
int iso__config_store(const struct iso_config_key *key, const char *value,
                      struct iso_config *config);

/* What a value of a key has to be, in words. */
void iso__config_describe(const struct iso_config_key *key, char *text, size_t size);

/* Keys that are sound alone and make no sense together: what is wrong, or NULL. (config_rules.c) */
const char *iso__config_find_conflict(const struct iso_config *config);

#endif
