/* A sensor given as one word of the command line: TYPE, or TYPE:KEY=VALUE,KEY=VALUE... with the
 * options of that back end (drivers/sensor/). Values hold no commas. */
#ifndef SIM_CORPUS_SENSOR_WORD_H
#define SIM_CORPUS_SENSOR_WORD_H

#include <stddef.h>

#include "core/base/fault.h"
#include "drivers/base/option.h"

enum { SIM_SENSOR_WORD_OPTIONS = 16 };

struct sim_sensor_word {
    char *text; /* owns the characters of the type and of the parsed options */
    const char *type;
    size_t n_options;
    struct iso_option options[SIM_SENSOR_WORD_OPTIONS];
};

/* Parses a word. Free it with sim_sensor_word_done. -EINVAL for an empty type, an option without a
 * key or without '=', or too many options; -ENOMEM.
 */
int sim_sensor_word_parse(const char *word, struct sim_sensor_word *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Adds an option; the texts are kept, not copied. -EINVAL if there is no room. */
int sim_sensor_word_add(struct sim_sensor_word *word, const char *key, const char *value,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* Frees the text and sets the struct to all zero, which is also accepted. */
void sim_sensor_word_done(struct sim_sensor_word *word);

#endif
