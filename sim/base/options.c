#include "sim/base/options.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "drivers/file/text.h"
#include "drivers/terminal/words.h"

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

int sim_option_flag(const char *text, void *field)
{
    (void)text;
    *(bool *)field = true;
    return 0;
}

int sim_option_list(const char *text, void *field)
{
    struct sim_option_texts *texts = field;
    if (texts->n == SIM_OPTION_TEXTS_MAX) {
        return -EINVAL;
    }
    texts->text[texts->n++] = text;
    return 0;
}

/* Finds the option whose name is the first `length` characters, and the struct that it belongs to.
 */
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

struct all_sets {
    const struct sim_option_set *sets;
    size_t n_sets;
};

static const char *next_name(size_t index, const void *context)
{
    const struct all_sets *all = context;
    for (size_t s = 0; s < all->n_sets; s++) {
        if (index < all->sets[s].n_options) {
            return all->sets[s].options[index].name;
        }
        index -= all->sets[s].n_options;
    }
    return index == 0 ? "help" : NULL;
}

static enum sim_options_outcome unknown(struct iso_fault *fault, const char *word, size_t length,
                                        const struct all_sets *all)
{
    char typed[64], why[128] = "unknown option";
    (void)snprintf(typed, sizeof typed, "%.*s", (int)length, word + 2);
    const char *meant = iso_words_nearest(typed, next_name, all);
    if (meant) {
        (void)snprintf(why, sizeof why, "unknown option; did you mean --%s?", meant);
    }
    return refuse(fault, word, why);
}

/* Reads argv[i], an option of the table, and its value; *i is then the index of its last word. */
static enum sim_options_outcome take(const struct sim_option *option, void *field, int argc,
                                     char **argv, int *i, struct iso_fault *fault)
{
    const char *word = argv[*i], *equals = strchr(word, '=');
    const char *value = equals ? equals + 1 : NULL;
    if (!option->value) {
        return value || option->parse("", field) ? refuse(fault, word, "takes no value")
                                                 : SIM_OPTIONS_READ;
    }
    if (!value && ++*i < argc) {
        value = argv[*i];
    }
    if (!value) {
        return refuse(fault, word, "a value must follow");
    }
    if (option->parse(value, field)) {
        (void)iso_fault_set(fault, 0, "--%s: '%s' is no %s", option->name, value, option->value);
        return SIM_OPTIONS_REFUSED;
    }
    return SIM_OPTIONS_READ;
}

enum sim_options_outcome sim_options_parse(int argc, char **argv, const struct sim_option_set *sets,
                                           size_t n_sets, struct iso_fault *fault)
{
    for (int i = 1; i < argc; i++) {
        const char *word = argv[i];
        if (strcmp(word, "--help") == 0) {
            return SIM_OPTIONS_HELP;
        }
        char *target = NULL;
        if (strncmp(word, "--", 2) != 0) {
            const struct sim_option *operand = find(sets, n_sets, "", 0, &target);
            if (!operand || operand->parse(word, target + operand->offset)) {
                return refuse(fault, word, operand ? "one too many" : "not an option");
            }
            continue;
        }
        const size_t length = strcspn(word + 2, "=");
        const struct sim_option *option = find(sets, n_sets, word + 2, length, &target);
        if (!option) {
            const struct all_sets all = {sets, n_sets};
            return unknown(fault, word, length, &all);
        }
        if (take(option, target + option->offset, argc, argv, &i, fault) != SIM_OPTIONS_READ) {
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
            const int width = fprintf(out, "  %s%s%s%s", option->name[0] ? "--" : "", option->name,
                                      option->name[0] ? " " : "",
                                      option->value ? option->value : "");
            fprintf(out, "%*s%s\n", width < 30 ? 30 - width : 1, "", option->help);
        }
    }
}
