#include "drivers/base/option.h"

#include <errno.h>
#include <string.h>

#include "drivers/file/text.h"

static bool is_known(const char *key, const char *const *known)
{
    while (*known && strcmp(*known, key) != 0) {
        known++;
    }
    return *known != NULL;
}

int iso_options_check(const char *owner, const struct iso_option *options, size_t n_options,
                      const char *const *known, struct iso_fault *fault)
{
    for (size_t i = 0; i < n_options; i++) {
        const char *key = options[i].key;
        if (!is_known(key, known)) {
            return iso_fault_set(fault, -EINVAL, "%s: unknown option '%s'", owner, key);
        }
        if (iso_options_find(options, n_options, key) != options[i].value) {
            return iso_fault_set(fault, -EINVAL, "%s: option '%s' is given twice", owner, key);
        }
    }
    return 0;
}

const char *iso_options_find(const struct iso_option *options, size_t n_options, const char *key)
{
    for (size_t i = 0; i < n_options; i++) {
        if (strcmp(options[i].key, key) == 0) {
            return options[i].value;
        }
    }
    return NULL;
}

int iso_options_bool(const char *owner, const struct iso_option *options, size_t n_options,
                     const char *key, bool otherwise, bool *out, struct iso_fault *fault)
{
    const char *value = iso_options_find(options, n_options, key);
    if (value && strcmp(value, "yes") != 0 && strcmp(value, "no") != 0) {
        return iso_fault_set(fault, -EINVAL, "%s: option '%s' is yes or no, not '%s'", owner, key,
                             value);
    }
    *out = value ? strcmp(value, "yes") == 0 : otherwise;
    return 0;
}

int iso_options_number(const char *owner, const struct iso_option *options, size_t n_options,
                       const char *key, double min, double max, double otherwise, double *out,
                       struct iso_fault *fault)
{
    const char *text = iso_options_find(options, n_options, key);
    double number = otherwise;
    if (text && *text && (iso_text_number(text, &number) || number < min || number > max)) {
        return iso_fault_set(fault, -EINVAL, "%s: option '%s' is a number, %g to %g, not '%s'",
                             owner, key, min, max, text);
    }
    *out = number;
    return 0;
}

int iso_options_required(const char *owner, const struct iso_option *options, size_t n_options,
                         const char *key, const char **out, struct iso_fault *fault)
{
    const char *text = iso_options_find(options, n_options, key);
    if (!text || !*text) {
        return iso_fault_set(fault, -EINVAL, "%s: option '%s' is missing", owner, key);
    }
    *out = text;
    return 0;
}
