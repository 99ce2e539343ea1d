/* isotherm-sim landmarks: how good landmarks are, what the gates refuse, what gets past them. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "sim/commands.h"
#include "sim/data_file.h"
#include "sim/eval/extract_options.h"
#include "sim/landmarks/study_pictures.h"

struct arguments {
    struct sim_study_options study;
    const char *out;
    size_t pictures;
};

#define FIELD(name) offsetof(struct arguments, name)

static const struct sim_option own_options[] = {
    {"corpus", "DIR", "recordings and manifest.csv", sim_option_text, FIELD(study.corpus)},
    {"out", "DIR", "where the results go (made if it is missing)", sim_option_text, FIELD(out)},
    {"pictures", "N", "draw the N worst frames and the first of every kind of result (0: none)",
     sim_option_count, FIELD(pictures)},
    {"threads", "N", "1..64 (a thread for each processor)", sim_option_threads,
     FIELD(study.threads)},
    {"model", "FILE", "head model", sim_option_text, FIELD(study.model)},
};

static int run(const struct arguments *arguments, struct iso_fault *fault)
{
    if (mkdir(arguments->out, 0777) != 0 && errno != EEXIST) {
        return iso_fault_set(fault, -errno, "%s: %s", arguments->out, strerror(errno));
    }
    struct sim_study *study = NULL;
    int error = sim_study_run(&arguments->study, &study, fault);
    if (error) {
        return error;
    }
    sim_study_text(study, stdout);
    error = sim_study_csv(study, arguments->out, fault);
    if (!error) {
        error = sim_study_json(study, arguments->out, fault);
    }
    if (!error && arguments->pictures > 0) {
        error = sim_study_pictures(study, arguments->out, arguments->pictures, fault);
    }
    sim_study_free(study);
    return error;
}

static int complain(const struct iso_fault *fault, int exit_code)
{
    fprintf(stderr, "isotherm-sim landmarks: %s\n", fault->text);
    return exit_code;
}

int sim_cmd_landmarks(int argc, char **argv)
{
    struct arguments arguments = {
        .study = {.model = SIM_DATA_FILE_MODEL, .extract = iso_extract_options_default()},
    };
    const struct sim_option_set sets[] = {
        {own_options, sizeof own_options / sizeof *own_options, &arguments},
        sim_extract_option_set(&arguments.study.extract),
    };
    size_t n_sets = sizeof sets / sizeof *sets;
    struct iso_fault fault = {""};
    switch (sim_options_parse(argc, argv, sets, n_sets, &fault)) {
    case SIM_OPTIONS_HELP:
        puts("Usage: isotherm-sim landmarks --corpus DIR --out DIR [OPTION...]\n\n"
             "Runs the extractor over every frame of a corpus, holds the landmarks against\n"
             "landmarks.csv, counts what is accepted and refused, of people and of what is none,\n"
             "and writes landmarks.csv, frames.csv and summary.json.\n");
        sim_options_help(sets, n_sets, stdout);
        return SIM_EXIT_OK;
    case SIM_OPTIONS_REFUSED:
        return complain(&fault, SIM_EXIT_USAGE);
    case SIM_OPTIONS_READ:
        break;
    }
    if (!arguments.study.corpus || !arguments.out) {
        (void)iso_fault_set(&fault, 0, "--corpus and --out are needed");
        return complain(&fault, SIM_EXIT_USAGE);
    }
    if (arguments.study.threads == 0) {
        arguments.study.threads = sim_threads_default(arguments.study.extract.heat);
    }
    int error = run(&arguments, &fault);
    if (!error) {
        return SIM_EXIT_OK;
    }
    return complain(&fault, error == -EINVAL   ? SIM_EXIT_USAGE
                            : error == -ENOENT ? SIM_EXIT_NOT_FOUND
                                               : SIM_EXIT_FAULT);
}
