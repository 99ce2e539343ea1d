/* isotherm-sim landmarks: measures the errors of landmarks, and which frames the gates refuse and
 * accept. */
#include <errno.h>
#include <stdio.h>

#include "drivers/base/shipped.h"
#include "sim/base/make_directory.h"
#include "sim/commands/command.h"
#include "sim/commands/commands.h"
#include "sim/lab/landmarks/study_pictures.h"
#include "sim/lab/match/extract_options.h"

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

static int run(void *target, struct iso_fault *fault)
{
    struct arguments *arguments = target;
    if (!arguments->study.corpus || !arguments->out) {
        return iso_fault_set(fault, -EINVAL, "--corpus and --out are needed");
    }
    if (arguments->study.threads == 0) {
        arguments->study.threads = sim_threads_default(arguments->study.extract.heat);
    }
    struct sim_study *study = NULL;
    int error = sim_make_directory(arguments->out, fault);
    if (!error) {
        error = sim_study_run(&arguments->study, &study, fault);
    }
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

int sim_cmd_landmarks(int argc, char **argv)
{
    struct arguments arguments = {
        .study = {.model = iso_shipped_model(), .extract = iso_extract_options_default()},
    };
    const struct sim_option_set sets[] = {
        {own_options, sizeof own_options / sizeof *own_options, &arguments},
        sim_extract_option_set(&arguments.study.extract),
    };
    const struct sim_command command = {
        .name = "landmarks",
        .needs = "--corpus DIR --out DIR",
        .summary =
            "Runs the extractor over every frame of a corpus, compares the landmarks with the\n"
            "corpus's landmarks.csv, counts the frames with and without people that are accepted\n"
            "and refused, and writes landmarks.csv, frames.csv and summary.json.",
        .run = run,
    };
    return sim_command_run(&command, sets, sizeof sets / sizeof *sets, argc, argv);
}
