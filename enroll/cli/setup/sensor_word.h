/* A sensor in one word: BACKEND, BACKEND:PLACE or BACKEND:PLACE,KEY=VALUE,... as in
 * "v4l2:/dev/video0,camera=/etc/isotherm/camera.ini". The keys are those of [sensor] in
 * isotherm.conf(5). The place is the device; for `replay`, or if it ends with ".oni", it is the
 * path of a recording. */
#ifndef CLI_SETUP_SENSOR_WORD_H
#define CLI_SETUP_SENSOR_WORD_H

#include <stdbool.h>
#include <stddef.h>

#include "enroll/cli/client/fault.h"

enum { CLI_SENSOR_OPTIONS = 12, CLI_SENSOR_VALUE_SIZE = 192 };

struct cli_sensor_word {
    char backend[32];
    size_t n_options;
    struct cli_sensor_option {
        char key[24], value[CLI_SENSOR_VALUE_SIZE];
    } options[CLI_SENSOR_OPTIONS];
};

/* Parses a word. CLI_EXIT_USAGE if it cannot be written into the configuration: it has no back end,
 * a key with other characters than a-z, 0-9 and _, an empty value, a value with control characters,
 * " ;" or blanks at its ends, a relative path, a value that is too long, or too many options. The
 * daemon checks later whether the back end exists and has such options. */
enum cli_exit cli_sensor_word_parse(const char *word, struct cli_sensor_word *out,
                                    struct cli_fault *fault) __attribute__((warn_unused_result));

/* Sets an option, or replaces its value. Faults of cli_sensor_word_parse(). */
enum cli_exit cli_sensor_word_set(struct cli_sensor_word *word, const char *key, const char *value,
                                  struct cli_fault *fault) __attribute__((warn_unused_result));

/* The value of an option, which belongs to `word`; NULL if it is not given. */
const char *cli_sensor_word_get(const struct cli_sensor_word *word, const char *key);

#endif
