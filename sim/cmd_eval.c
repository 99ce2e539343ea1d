/* isotherm-sim eval: how well people in a corpus are recognised. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "sim/commands.h"
#include "sim/data_file.h"
#include "sim/eval/eval.h"
#include "sim/eval/extract_options.h"
#include "sim/eval/report.h"

struct arguments {
    struct sim_eval_options eval;
    const char *out, *method;
};

#define FIELD(name) offsetof(struct arguments, name)

static const struct sim_option own_options[] = {
    {"corpus", "DIR", "recordings and manifest.csv", sim_option_text, FIELD(eval.corpus)},
    {"out", "DIR", "where the results go (made if it is missing)", sim_option_text, FIELD(out)},
    {"method", "hfpc", "how faces are described and compared", sim_option_text, FIELD(method)},
    {"fuse", "N", "frames of a row in one sample (0: all of them)", sim_option_count,
     FIELD(eval.fuse)},
    {"gallery-limit", "N", "enrol the first N people (0: all)", sim_option_count,
     FIELD(eval.gallery_limit)},
    {"threads", "N", "1..64 (a thread for each processor)", sim_option_threads,
     FIELD(eval.threads)},
    {"model", "FILE", "head model", sim_option_text, FIELD(eval.model)},
    {"cohort", "FILE", "templates that normalise the score", sim_option_text, FIELD(eval.cohort)},
};

static int run(const struct arguments *arguments, struct iso_fault *fault)
{
    if (mkdir(arguments->out, 0777) != 0 && errno != EEXIST) {
        return iso_fault_set(fault, -errno, "%s: %s", arguments->out, strerror(errno));
    }
    struct sim_eval *eval = NULL;
    int error = sim_eval_run(&arguments->eval, &eval, fault);
    if (error) {
        return error;
    }
    sim_report_text(eval, stdout);
    error = sim_report_csv(eval, arguments->out, fault);
    if (!error) {
        error = sim_report_json(eval, arguments->out, fault);
    }
    if (!error) {
        error = sim_report_plots(eval, arguments->out, fault);
    }
    sim_eval_free(eval);
    return error;
}

static int complain(const struct iso_fault *fault, int exit_code)
{
    fprintf(stderr, "isotherm-sim eval: %s\n", fault->text);
    return exit_code;
}

int sim_cmd_eval(int argc, char **argv)
{
    struct arguments arguments = {
        .eval = {.model = SIM_DATA_FILE_MODEL,
                 .extract = iso_extract_options_default(),
                 .match = iso_match_options_default()},
        .method = "hfpc",
    };
    const struct sim_option_set sets[] = {
        {own_options, sizeof own_options / sizeof *own_options, &arguments},
        sim_extract_option_set(&arguments.eval.extract),
        sim_match_option_set(&arguments.eval.match),
    };
    size_t n_sets = sizeof sets / sizeof *sets;
    struct iso_fault fault = {""};
    switch (sim_options_parse(argc, argv, sets, n_sets, &fault)) {
    case SIM_OPTIONS_HELP:
        puts("Usage: isotherm-sim eval --corpus DIR --out DIR [OPTION...]\n\n"
             "Enrols the gallery of a corpus, searches it for every probe, and writes scores.csv,\n"
             "landmarks.csv, cmc.csv, det.csv, summary.json and plots.\n");
        sim_options_help(sets, n_sets, stdout);
        return SIM_EXIT_OK;
    case SIM_OPTIONS_REFUSED:
        return complain(&fault, SIM_EXIT_USAGE);
    case SIM_OPTIONS_READ:
        break;
    }
    if (!arguments.eval.corpus || !arguments.out) {
        (void)iso_fault_set(&fault, 0, "--corpus and --out are needed");
        return complain(&fault, SIM_EXIT_USAGE);
    }
    if (strcmp(arguments.method, "hfpc") != 0) {
        (void)iso_fault_set(&fault, 0, "--method: '%s' is unknown (hfpc)", arguments.method);
        return complain(&fault, SIM_EXIT_USAGE);
    }
    if (arguments.eval.threads == 0) {
        arguments.eval.threads = sim_threads_default(arguments.eval.extract.heat);
    }
    int error = run(&arguments, &fault);
    if (!error) {
        return SIM_EXIT_OK;
    }
    return complain(&fault, error == -EINVAL   ? SIM_EXIT_USAGE
                            : error == -ENOENT ? SIM_EXIT_NOT_FOUND
                                               : SIM_EXIT_FAULT);
}
