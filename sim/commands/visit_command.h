/* What the commands share that play the visits of a corpus: they read options, print each visit
 * when it ends, write visits.csv, print the summary, and return an exit code. */
#ifndef SIM_COMMANDS_VISIT_COMMAND_H
#define SIM_COMMANDS_VISIT_COMMAND_H

#include <stdbool.h>

#include "sim/base/options.h"
#include "sim/door/visit.h"

struct sim_visit_command {
    const char *name;           /* of the command */
    const char *usage;          /* the text of --help before the options */
    const char *needed;         /* the error text for a missing option */
    struct sim_option_set set;  /* its target is passed to the two functions below */
    const char **corpus, **out; /* fields of the target: directories */
    bool out_may_exist;
    bool (*is_complete)(const void *target); /* whether all required options were given */
    /* Plays the visits like sim_visit_play or sim_rehearse. */
    int (*play)(const void *target, const struct sim_corpus *corpus, sim_visit_listener *listener,
                void *context, struct sim_visit *visits, size_t *n_visits, struct iso_fault *fault);
};

/* Runs the command. argv begins with the command's name. Returns an exit code
 * (sim/commands/commands.h): SIM_EXIT_NO_MATCH if the summary is not good. */
int sim_visit_command_run(const struct sim_visit_command *command, int argc, char **argv);

#endif
