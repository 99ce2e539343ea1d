/* isotherm-sim replay: a corpus played to the appliance itself on a virtual clock. */
#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "sim/commands.h"
#include "sim/data_file.h"
#include "sim/options.h"
#include "sim/visit/rehearsal.h"
#include "sim/visit/visit_report.h"

struct arguments {
    struct sim_rehearsal_options rehearsal;
};

#define FIELD(name) offsetof(struct arguments, name)

static const struct sim_option options[] = {
    {"corpus", "DIR", "recordings and manifest.csv", sim_option_text, FIELD(rehearsal.corpus)},
    {"out", "DIR", "where visits.csv, gallery and log go; made, must not exist", sim_option_text,
     FIELD(rehearsal.state)},
    {"model", "FILE", "head model", sim_option_text, FIELD(rehearsal.model)},
    {"cohort", "FILE", "templates that normalise the score", sim_option_text,
     FIELD(rehearsal.cohort)},
    {"threshold", "SCORE", "instead of the configuration's own", sim_option_number,
     FIELD(rehearsal.threshold)},
};

static void print_visit(const struct sim_visit *visit, void *context)
{
    (void)context;
    sim_visit_print(visit, stdout);
}

static int replay(const struct sim_rehearsal_options *rehearsal, struct sim_visit_summary *summary,
                  struct iso_fault *fault)
{
    struct sim_corpus *corpus = NULL;
    struct sim_visit *visits = NULL;
    size_t n_visits = 0;
    int error = sim_corpus_read(rehearsal->corpus, &corpus, fault);
    if (error) {
        return error;
    }
    visits = calloc(corpus->n_rows, sizeof *visits);
    if (!visits) {
        error = iso_fault_set(fault, -ENOMEM, "out of memory");
    } else if (mkdir(rehearsal->state, 0777) != 0) {
        error = iso_fault_set(fault, -errno, "%s: %s", rehearsal->state, strerror(errno));
    } else {
        sim_visit_print_head(stdout);
        error = sim_rehearse(rehearsal, corpus, print_visit, NULL, visits, &n_visits, fault);
    }
    error = error ? error : sim_visit_write_csv(rehearsal->state, visits, n_visits, fault);
    if (!error) {
        *summary = sim_visit_judge(visits, n_visits);
        sim_visit_print_summary(summary, stdout);
    }
    free(visits);
    sim_corpus_free(corpus);
    return error;
}

static int complain(const struct iso_fault *fault, int exit_code)
{
    fprintf(stderr, "isotherm-sim replay: %s\n", fault->text);
    return exit_code;
}

int sim_cmd_replay(int argc, char **argv)
{
    struct arguments arguments = {.rehearsal = {.model = SIM_DATA_FILE_MODEL,
                                                .cohort = SIM_DATA_FILE_COHORT,
                                                .threshold = NAN}};
    const struct sim_option_set set = {options, sizeof options / sizeof *options, &arguments};
    struct sim_visit_summary summary = {0};
    struct iso_fault fault = {""};

    switch (sim_options_parse(argc, argv, &set, 1, &fault)) {
    case SIM_OPTIONS_HELP:
        puts(
            "Usage: isotherm-sim replay --corpus DIR --out DIR [OPTION...]\n\n"
            "Enrols the gallery of a corpus and plays its visits to the appliance itself, in this "
            "process\nand on a virtual clock: no daemon, no bus, no waiting, and the same verdicts "
            "every time.\nExit status 1: somebody enrolled was refused at every visit or taken "
            "for another, or a\nstranger was let in.\n");
        sim_options_help(&set, 1, stdout);
        return SIM_EXIT_OK;
    case SIM_OPTIONS_REFUSED:
        return complain(&fault, SIM_EXIT_USAGE);
    case SIM_OPTIONS_READ:
        break;
    }
    if (!arguments.rehearsal.corpus || !arguments.rehearsal.state) {
        (void)iso_fault_set(&fault, 0, "--corpus and --out are needed");
        return complain(&fault, SIM_EXIT_USAGE);
    }
    const int error = replay(&arguments.rehearsal, &summary, &fault);
    if (error) {
        return complain(&fault, error == -ENOENT ? SIM_EXIT_NOT_FOUND : SIM_EXIT_FAULT);
    }
    return summary.good ? SIM_EXIT_OK : SIM_EXIT_NO_MATCH;
}
