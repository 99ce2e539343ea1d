#include "sim/commands/visit_command.h"

#include <errno.h>
#include <stdlib.h>

#include "sim/base/make_directory.h"
#include "sim/commands/commands.h"
#include "sim/door/visit_report.h"

static void print_visit(const struct sim_visit *visit, void *context)
{
    (void)context;
    sim_visit_print(visit, stdout);
    fflush(stdout);
}

static int play_corpus(const struct sim_visit_command *command, const struct sim_corpus *corpus,
                       struct sim_visit_summary *summary, struct iso_fault *fault)
{
    size_t n_visits = 0;
    struct sim_visit *visits = calloc(corpus->n_rows, sizeof *visits);
    if (!visits) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    sim_visit_print_head(stdout);
    int error = command->play(command->set.target, corpus, print_visit, NULL, visits, &n_visits,
                              fault);
    if (!error) {
        error = sim_visit_write_csv(*command->out, visits, n_visits, fault);
    }
    if (!error) {
        *summary = sim_visit_judge(visits, n_visits);
        sim_visit_print_summary(summary, stdout);
    }
    free(visits);
    return error;
}

static int play(const struct sim_visit_command *command, struct sim_visit_summary *summary,
                struct iso_fault *fault)
{
    struct sim_corpus *corpus = NULL;
    int error = sim_corpus_read(*command->corpus, &corpus, fault);
    if (error) {
        return error;
    }
    error = command->out_may_exist ? sim_make_directory(*command->out, fault)
                                   : sim_make_new_directory(*command->out, fault);
    if (!error) {
        error = play_corpus(command, corpus, summary, fault);
    }
    sim_corpus_free(corpus);
    return error;
}

static int complain(const struct sim_visit_command *command, const struct iso_fault *fault,
                    int exit_code)
{
    fprintf(stderr, "isotherm-sim %s: %s\n", command->name, fault->text);
    return exit_code;
}

static int exit_code_of(int error)
{
    switch (error) {
    case -ENOENT:
        return SIM_EXIT_NOT_FOUND;
    case -ETIMEDOUT:
        return SIM_EXIT_TIMED_OUT;
    default:
        return SIM_EXIT_FAULT;
    }
}

int sim_visit_command_run(const struct sim_visit_command *command, int argc, char **argv)
{
    struct sim_visit_summary summary = {0};
    struct iso_fault fault = {.text = ""};

    switch (sim_options_parse(argc, argv, &command->set, 1, &fault)) {
    case SIM_OPTIONS_HELP:
        puts(command->usage);
        sim_options_help(&command->set, 1, stdout);
        return SIM_EXIT_OK;
    case SIM_OPTIONS_REFUSED:
        return complain(command, &fault, SIM_EXIT_USAGE);
    case SIM_OPTIONS_READ:
        break;
    }
    if (!command->is_complete(command->set.target)) {
        (void)iso_fault_set(&fault, 0, "%s", command->needed);
        return complain(command, &fault, SIM_EXIT_USAGE);
    }
    const int error = play(command, &summary, &fault);
    if (error) {
        return complain(command, &fault, exit_code_of(error));
    }
    return summary.good ? SIM_EXIT_OK : SIM_EXIT_NO_MATCH;
}
