/* The frame of a command: its options, its help, its complaints, its exit code. */
#ifndef SIM_COMMANDS_COMMAND_H
#define SIM_COMMANDS_COMMAND_H

#include "sim/base/options.h"

struct sim_command {
    const char *name;    /* "eval"; of a group of commands "shapes eval" */
    const char *needs;   /* what must be given: "--corpus DIR --out DIR" */
    const char *summary; /* what --help says of it: lines, the last one not ended */
    /* Gets the target of the first set of options. 0, or a negative errno with a fault: -EINVAL for
     * arguments that will not do, -ENOENT for what is not there. */
    int (*run)(void *arguments, struct iso_fault *fault);
    void (*notes)(FILE *out); /* OPTIONAL: below the options */
};

/* One of a group, all of which fill in the same arguments. */
struct sim_subcommand {
    struct sim_command command;
    const struct sim_option *options;
    size_t n_options;
};

/* What a command ends with after such an error: SIM_EXIT_USAGE for -EINVAL, SIM_EXIT_NOT_FOUND for
 * -ENOENT, else SIM_EXIT_FAULT. */
int sim_command_exit_code(int error);

/* Runs a command with argv from its name on; an exit code of sim/commands/commands.h. */
int sim_command_run(const struct sim_command *command, const struct sim_option_set *sets,
                    size_t n_sets, int argc, char **argv);

/* Runs the one that argv[1] names, argv being from the group's name on. */
int sim_subcommand_run(const char *group, const struct sim_subcommand *list, size_t n,
                       void *arguments, int argc, char **argv);

#endif
