/* What all commands share: they read options, print help and errors, and return an exit code. */
#ifndef SIM_COMMANDS_COMMAND_H
#define SIM_COMMANDS_COMMAND_H

#include "sim/base/options.h"

struct sim_command {
    const char *name;    /* "eval"; for a command of a group "shapes eval" */
    const char *needs;   /* the required options: "--corpus DIR --out DIR" */
    const char *summary; /* the description for --help: lines, the last one without a newline */
    /* Does the work. `arguments` is the target of the first set of options. 0, or a negative errno
     * with a fault: -EINVAL for invalid arguments, -ENOENT for missing files. */
    int (*run)(void *arguments, struct iso_fault *fault);
    void (*notes)(FILE *out); /* OPTIONAL: prints notes below the options of --help */
};

/* A command of a group. All commands of a group fill in the same arguments. */
struct sim_subcommand {
    struct sim_command command;
    const struct sim_option *options;
    size_t n_options;
};

/* The exit code for an error: SIM_EXIT_USAGE for -EINVAL, SIM_EXIT_NOT_FOUND for -ENOENT, else
 * SIM_EXIT_FAULT. */
int sim_command_exit_code(int error);

/* Runs a command. argv begins with the command's name. Returns an exit code
 * (sim/commands/commands.h). */
int sim_command_run(const struct sim_command *command, const struct sim_option_set *sets,
                    size_t n_sets, int argc, char **argv);

/* Runs the command of the group that argv[1] names. argv begins with the group's name. Returns an
 * exit code. */
int sim_subcommand_run(const char *group, const struct sim_subcommand *list, size_t n,
                       void *arguments, int argc, char **argv);

#endif
