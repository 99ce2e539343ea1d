/* Key and value pairs that a back end is opened with: a section of the configuration. */
#ifndef ISO_DRIVERS_BASE_OPTION_H
#define ISO_DRIVERS_BASE_OPTION_H

#include <stdbool.h>
#include <stddef.h>

#include "core/base/fault.h"

struct iso_option {
    const char *key, *value;
};

/* Refuses keys outside `known` (ended by NULL) and repeated keys: 0, or -EINVAL with a fault that
 * names `owner` (such as "sensor replay") and the key. */
int iso_options_check(const char *owner, const struct iso_option *options, size_t n_options,
                      const char *const *known, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The value of a key, or NULL. */
const char *iso_options_find(const struct iso_option *options, size_t n_options, const char *key);

/* "yes" or "no", or `otherwise` if the key is absent. -EINVAL with a fault for another value. */
int iso_options_bool(const char *owner, const struct iso_option *options, size_t n_options,
                     const char *key, bool otherwise, bool *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The number behind a key, within min..max, or `otherwise` if the key is absent or empty. -EINVAL
 * with a fault. */
int iso_options_number(const char *owner, const struct iso_option *options, size_t n_options,
                       const char *key, double min, double max, double otherwise, double *out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* The text behind a key. -EINVAL with a fault if it is absent or empty. */
int iso_options_required(const char *owner, const struct iso_option *options, size_t n_options,
                         const char *key, const char **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
