/* Long options of the simulator's commands, described by tables.
 *
 * The client and the daemon read theirs by getopt_long, which also takes short and abbreviated
 * names. A command of the simulator joins several tables, and reads numbers, angles and lists
 * straight into the fields of its options; getopt_long knows nothing of either. */
#ifndef SIM_BASE_OPTIONS_H
#define SIM_BASE_OPTIONS_H

#include <stddef.h>
#include <stdio.h>

#include "core/base/fault.h"

/* Reads a value's text into a field; -EINVAL, the field untouched, if it is no such value. */
typedef int sim_option_parser(const char *text, void *field);

sim_option_parser sim_option_text;    /* const char *: points into argv */
sim_option_parser sim_option_count;   /* size_t */
sim_option_parser sim_option_int;     /* int, >= 0 */
sim_option_parser sim_option_number;  /* double */
sim_option_parser sim_option_degrees; /* double, radians */
sim_option_parser sim_option_flag;    /* bool, made true: for options that take no value */
sim_option_parser sim_option_list; /* struct sim_option_texts: for options that may be repeated */

enum { SIM_OPTION_TEXTS_MAX = 64 };

/* The values of an option that was given n times. */
struct sim_option_texts {
    size_t n;
    const char *text[SIM_OPTION_TEXTS_MAX];
};

struct sim_option {
    const char *name;  /* without the dashes */
    const char *value; /* what to call its value in the help; NULL: it takes none */
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
    SIM_OPTIONS_HELP,   /* --help was among them */
    SIM_OPTIONS_REFUSED /* with a fault that names the option */
};

/* Reads `--name VALUE`, `--name=VALUE` and flags from argv[1] on; anything else is refused.
 * The fault of an unknown option names the option that may have been meant. */
enum sim_options_outcome sim_options_parse(int argc, char **argv, const struct sim_option_set *sets,
                                           size_t n_sets, struct iso_fault *fault);

/* The options of all sets, a line each. */
void sim_options_help(const struct sim_option_set *sets, size_t n_sets, FILE *out);

#endif
