#include "sim/corpus/sensor_word.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

int sim_sensor_word_add(struct sim_sensor_word *word, const char *key, const char *value,
                        struct iso_fault *fault)
{
    if (word->n_options == SIM_SENSOR_WORD_OPTIONS) {
        return iso_fault_set(fault, -EINVAL, "sensor %s: more than %d options", word->type,
                             SIM_SENSOR_WORD_OPTIONS);
    }
    word->options[word->n_options++] = (struct iso_option){key, value};
    return 0;
}

static int parse_options(char *rest, struct sim_sensor_word *word, struct iso_fault *fault)
{
    char *option;
    while ((option = strsep(&rest, ","))) {
        char *value = strchr(option, '=');
        if (!value || value == option) {
            return iso_fault_set(fault, -EINVAL, "sensor %s: '%s' is not KEY=VALUE", word->type,
                                 option);
        }
        *value++ = '\0';
        const int error = sim_sensor_word_add(word, option, value, fault);
        if (error) {
            return error;
        }
    }
    return 0;
}

int sim_sensor_word_parse(const char *word, struct sim_sensor_word *out, struct iso_fault *fault)
{
    struct sim_sensor_word parsed = {.text = strdup(word)};
    if (!parsed.text) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    char *rest = parsed.text;
    int error = 0;
    parsed.type = strsep(&rest, ":");
    if (!*parsed.type) {
        error = iso_fault_set(fault, -EINVAL, "'%s' names no sensor", word);
    } else if (rest) {
        error = parse_options(rest, &parsed, fault);
    }
    if (error) {
        sim_sensor_word_done(&parsed);
        return error;
    }
    *out = parsed;
    return 0;
}

void sim_sensor_word_done(struct sim_sensor_word *word)
{
    free(word->text);
    *word = (struct sim_sensor_word){0};
}
