/* Long options of the simulator's commands, described by tables.
 *
 * The client and the daemon read their options with getopt_long, which also accepts short and
 * abbreviated names. A command of the simulator joins several tables, and reads numbers, angles
 * and lists directly into the fields of its options; getopt_long supports neither. */
#ifndef SIM_BASE_OPTIONS_H
#define SIM_BASE_OPTIONS_H

#include <stddef.h>
#include <stdio.h>

#include "core/base/fault.h"

/* Reads a value's text into a field. -EINVAL if the text is invalid; the field is then unchanged.
 */
typedef int sim_option_parser(const char *text, void *field);

sim_option_parser sim_option_text;    /* const char *: points into argv */
sim_option_parser sim_option_count;   /* size_t */
sim_option_parser sim_option_int;     /* int, >= 0 */
sim_option_parser sim_option_number;  /* double */
sim_option_parser sim_option_degrees; /* double, radians */
sim_option_parser sim_option_flag;    /* bool, set to true: for options without a value */
sim_option_parser sim_option_list; /* struct sim_option_texts: for options that may be repeated */

enum { SIM_OPTION_TEXTS_MAX = 512 };

/* The n values of a repeated option. */
struct sim_option_texts {
    size_t n;
    const char *text[SIM_OPTION_TEXTS_MAX];
};

struct sim_option {
    const char *name;  /* without the dashes; "": takes the words that are no options */
    const char *value; /* name of the value in the help; NULL: the option has no value */
    const char *help;  /* one line */
    sim_option_parser *parse;
    size_t offset; /* of the field in the target */
};

/* A table and the struct that its fields belong to. */
struct sim_option_set {
    const struct sim_option *options;
    size_t n_options;
    void *target;
};

enum sim_options_outcome {
    SIM_OPTIONS_READ,
    SIM_OPTIONS_HELP,   /* --help was given */
    SIM_OPTIONS_REFUSED /* with a fault that names the option */
};

/* Reads `--name VALUE`, `--name=VALUE` and flags from argv[1] on. The option without a name, if
 * there is one, takes all other arguments; otherwise they are refused. The fault for an unknown
 * option names the most similar known option. */
enum sim_options_outcome sim_options_parse(int argc, char **argv, const struct sim_option_set *sets,
                                           size_t n_sets, struct iso_fault *fault);

/* Prints the options of all sets, one line each. */
void sim_options_help(const struct sim_option_set *sets, size_t n_sets, FILE *out);

#endif
