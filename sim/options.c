#include "sim/options.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "drivers/text.h"

int sim_option_text(const char *text, void *field)
{
    *(const char **)field = text;
    return 0;
}

int sim_option_count(const char *text, void *field)
{
    return iso_text_count(text, field);
}

int sim_option_int(const char *text, void *field)
{
    size_t count;
    if (iso_text_count(text, &count) || count > INT_MAX) {
        return -EINVAL;
    }
    *(int *)field = (int)count;
    return 0;
}

int sim_option_number(const char *text, void *field)
{
    return iso_text_number(text, field);
}

int sim_option_degrees(const char *text, void *field)
{
    double degrees;
    if (iso_text_number(text, &degrees)) {
        return -EINVAL;
    }
    *(double *)field = degrees * M_PI / 180.0;
    return 0;
}

/* The option whose name is the first `length` characters, and the struct it belongs to. */
static const struct sim_option *find(const struct sim_option_set *sets, size_t n_sets,
                                     const char *name, size_t length, char **target)
{
    for (size_t s = 0; s < n_sets; s++) {
        for (size_t i = 0; i < sets[s].n_options; i++) {
            const struct sim_option *option = &sets[s].options[i];
            if (strlen(option->name) == length && strncmp(option->name, name, length) == 0) {
                *target = sets[s].target;
                return option;
            }
        }
    }
    return NULL;
}

static enum sim_options_outcome refuse(struct iso_fault *fault, const char *what, const char *why)
{
    (void)iso_fault_set(fault, 0, "%s: %s", what, why);
    return SIM_OPTIONS_REFUSED;
}

enum sim_options_outcome sim_options_parse(int argc, char **argv, const struct sim_option_set *sets,
                                           size_t n_sets, struct iso_fault *fault)
{
    for (int i = 1; i < argc; i++) {
        const char *word = argv[i];
        if (strcmp(word, "--help") == 0) {
            return SIM_OPTIONS_HELP;
        }
        if (strncmp(word, "--", 2) != 0) {
            return refuse(fault, word, "not an option");
        }
        char *target = NULL;
        size_t length = strcspn(word + 2, "=");
        const struct sim_option *option = find(sets, n_sets, word + 2, length, &target);
        if (!option) {
            return refuse(fault, word, "unknown option");
        }
        const char *value = word[2 + length] == '=' ? word + 2 + length + 1 : NULL;
        if (!value && ++i < argc) {
            value = argv[i];
        }
        if (!value) {
            return refuse(fault, word, "a value must follow");
        }
        if (option->parse(value, target + option->offset)) {
            (void)iso_fault_set(fault, 0, "--%s: '%s' is no %s", option->name, value,
                                option->value);
            return SIM_OPTIONS_REFUSED;
        }
    }
    return SIM_OPTIONS_READ;
}

void sim_options_help(const struct sim_option_set *sets, size_t n_sets, FILE *out)
{
    for (size_t s = 0; s < n_sets; s++) {
        for (size_t i = 0; i < sets[s].n_options; i++) {
            const struct sim_option *option = &sets[s].options[i];
            int width = fprintf(out, "  --%s %s", option->name, option->value);
            fprintf(out, "%*s%s\n", width < 30 ? 30 - width : 1, "", option->help);
        }
    }
}
