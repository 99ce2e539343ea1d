/* What the commands that play a corpus's visits have in common: the options, the table of visits as
 * they come, visits.csv, the summary, and the exit code. */
#ifndef SIM_COMMANDS_VISIT_COMMAND_H
#define SIM_COMMANDS_VISIT_COMMAND_H

#include <stdbool.h>

#include "sim/base/options.h"
#include "sim/door/visit.h"

struct sim_visit_command {
    const char *name;           /* of the command */
    const char *usage;          /* what --help says before the options */
    const char *needed;         /* what is said when an option is missing */
    struct sim_option_set set;  /* its target is handed to the two below */
    const char **corpus, **out; /* fields of the target */
    bool out_may_exist;
    bool (*is_complete)(const void *target); /* all options that are needed were given */
    /* As sim_visit_play and sim_rehearse. */
    int (*play)(const void *target, const struct sim_corpus *corpus, sim_visit_listener *listener,
                void *context, struct sim_visit *visits, size_t *n_visits, struct iso_fault *fault);
};

/* Runs the command with argv from its own name on; an exit code of sim/commands/commands.h. */
int sim_visit_command_run(const struct sim_visit_command *command, int argc, char **argv);

#endif
