#include "drivers/base/option.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "drivers/file/text.h"

/* ---- the table ---- */

const struct iso_option_spec *iso_option_find_spec(const struct iso_option_spec *specs,
                                                   const char *name)
{
    for (; specs && specs->name; specs++) {
        if (strcmp(specs->name, name) == 0) {
            return specs;
        }
    }
    return NULL;
}

int iso_option_find_choice(const char *choices, const char *word)
{
    const size_t length = strlen(word);
    for (int i = 0;; i++) {
        const char *end = strchrnul(choices, '|');
        if ((size_t)(end - choices) == length && strncmp(choices, word, length) == 0) {
            return i;
        }
        if (!*end) {
            return -1;
        }
        choices = end + 1;
    }
}

void iso_option_describe(const struct iso_option_spec *spec, char *text, size_t size)
{
    switch (spec->kind) {
    case ISO_OPTION_NUMBER:
        (void)snprintf(text, size, "a number, %.10g to %.10g", spec->min, spec->max);
        return;
    case ISO_OPTION_COUNT:
        (void)snprintf(text, size, "a whole number, %.0f to %.0f", spec->min, spec->max);
        return;
    case ISO_OPTION_CHOICE:
        (void)snprintf(text, size, "%s", spec->choices);
        return;
    case ISO_OPTION_SWITCH:
        (void)snprintf(text, size, "no|yes");
        return;
    case ISO_OPTION_TEXT:
    case ISO_OPTION_PATH:
    case ISO_OPTION_LINE:
        break;
    }
    (void)snprintf(text, size, "%s", "");
}

/* ---- checks ---- */

static bool is_in_range(const struct iso_option_spec *spec, const char *value)
{
    double number;
    size_t count;
    switch (spec->kind) {
    case ISO_OPTION_NUMBER:
        return !iso_text_number(value, &number) && number >= spec->min && number <= spec->max;
    case ISO_OPTION_COUNT:
        return !iso_text_count(value, &count) && (double)count >= spec->min &&
               (double)count <= spec->max;
    case ISO_OPTION_CHOICE:
        return iso_option_find_choice(spec->choices, value) >= 0;
    case ISO_OPTION_SWITCH:
        return iso_option_find_choice("no|yes", value) >= 0;
    case ISO_OPTION_TEXT:
    case ISO_OPTION_PATH:
    case ISO_OPTION_LINE:
        break;
    }
    return true;
}

int iso_option_check_value(const struct iso_option_spec *spec, const char *value,
                           struct iso_fault *fault)
{
    char expected[96];
    struct iso_fault why = {.text = ""};
    if (!*value) {
        return 0;
    }
    if (!is_in_range(spec, value)) {
        iso_option_describe(spec, expected, sizeof expected);
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "bad value '%s' for '%s' (%s)", value, spec->name, expected);
    }
    if (!spec->check || spec->check(value, &why) == 0) {
        return 0;
    }
    (void)iso_fault_code_default(&why, ISO_FAULT_OPTION_WRONG, -EINVAL);
    return iso_fault_set_code(fault, why.code, -EINVAL, "%s: %s", spec->name, why.text);
}

static int check_given(const char *owner, const struct iso_option_set *set,
                       const struct iso_option *option, struct iso_fault *fault)
{
    const struct iso_option_spec *spec = iso_option_find_spec(set->specs, option->key);
    struct iso_fault why = {.text = ""};
    if (!spec) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL, "%s: unknown option '%s'",
                                  owner, option->key);
    }
    if (iso_options_find(set->options, set->n_options, option->key) != option->value) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s: option '%s' is given twice", owner, option->key);
    }
    const int error = iso_option_check_value(spec, option->value, &why);
    return error ? iso_fault_set_code(fault, why.code, error, "%s: %s", owner, why.text) : 0;
}

int iso_options_check(const char *owner, const struct iso_option_set *set, struct iso_fault *fault)
{
    for (size_t i = 0; i < set->n_options; i++) {
        const int error = check_given(owner, set, &set->options[i], fault);
        if (error) {
            return error;
        }
    }
    for (const struct iso_option_spec *spec = set->specs; spec && spec->name; spec++) {
        if (spec->required && !iso_option_is_given(set, spec->name)) {
            return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                      "%s: option '%s' is missing", owner, spec->name);
        }
    }
    return 0;
}

/* ---- values ---- */

const char *iso_options_find(const struct iso_option *options, size_t n_options, const char *key)
{
    for (size_t i = 0; i < n_options; i++) {
        if (strcmp(options[i].key, key) == 0) {
            return options[i].value;
        }
    }
    return NULL;
}

bool iso_option_is_given(const struct iso_option_set *set, const char *name)
{
    const char *value = iso_options_find(set->options, set->n_options, name);
    return value && *value;
}

const char *iso_option_text(const struct iso_option_set *set, const char *name)
{
    const struct iso_option_spec *spec = iso_option_find_spec(set->specs, name);
    if (iso_option_is_given(set, name)) {
        return iso_options_find(set->options, set->n_options, name);
    }
    return spec && spec->standard ? spec->standard : "";
}

bool iso_option_switch(const struct iso_option_set *set, const char *name)
{
    return strcmp(iso_option_text(set, name), "yes") == 0;
}

double iso_option_number(const struct iso_option_set *set, const char *name)
{
    double number = 0.0;
    return iso_text_number(iso_option_text(set, name), &number) ? 0.0 : number;
}

int iso_option_choice(const struct iso_option_set *set, const char *name)
{
    const struct iso_option_spec *spec = iso_option_find_spec(set->specs, name);
    return spec && spec->choices ? iso_option_find_choice(spec->choices, iso_option_text(set, name))
                                 : -1;
}
