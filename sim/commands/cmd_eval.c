/* isotherm-sim eval: measures how well the people of a corpus are recognised. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"
#include "drivers/base/shipped.h"
#include "sim/base/make_directory.h"
#include "sim/commands/command.h"
#include "sim/commands/commands.h"
#include "sim/lab/eval/eval.h"
#include "sim/lab/eval/method_options.h"
#include "sim/lab/match/extract_options.h"
#include "sim/lab/report/report.h"
#include "sim/lab/report/report_methods.h"

struct arguments {
    struct sim_option_texts corpora;
    struct sim_eval_options eval;
    struct sim_method_choice choice;
    const char *out, *train;
};

/* The value of --gallery. */
static int parse_enrolled(const char *text, void *field)
{
    static const char *const names[] = {"role", "frontal", "poses"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (strcmp(text, names[i]) == 0) {
            *(enum sim_enrolled *)field = (enum sim_enrolled)i;
            return 0;
        }
    }
    return -EINVAL;
}

#define FIELD(name) offsetof(struct arguments, name)

static const struct sim_option own_options[] = {
    {"corpus", "DIR", "recordings and manifest.csv; may be repeated", sim_option_list,
     FIELD(corpora)},
    {"out", "DIR", "where the results go (made if it is missing)", sim_option_text, FIELD(out)},
    {"method", "NAME,...|all", "how faces are described and compared (hfpc)", sim_option_methods,
     FIELD(choice)},
    {"train", "DIR", "corpus of other people that methods learn from", sim_option_text,
     FIELD(train)},
    {"site", "none|gallery|sensor|split",
     "adapt the metric to the enrolled people; to those enrolled before the sensor of the "
     "searches; "
     "or learn from half of the people and judge the others",
     sim_option_site, FIELD(eval.site)},
    {"fuse", "N", "fuse N frames of a row to one template (0: all)", sim_option_count,
     FIELD(eval.fuse)},
    {"gallery", "role|frontal|poses",
     "enrol the rows of the role gallery; rows of the same session in another pose are left out, "
     "or "
     "enrolled",
     parse_enrolled, FIELD(eval.enrolled)},
    {"gallery-frames", "N", "use the first N frames of a row of the gallery (0: all)",
     sim_option_count, FIELD(eval.gallery_frames)},
    {"probe-frames", "N", "use the first N frames of any other row (0: all)", sim_option_count,
     FIELD(eval.probe_frames)},
    {"gallery-limit", "N", "enrol the first N people (0: all)", sim_option_count,
     FIELD(eval.gallery_limit)},
    {"threads", "N", "1..64 (a thread for each processor)", sim_option_threads,
     FIELD(eval.threads)},
    {"model", "FILE", "head model", sim_option_text, FIELD(eval.model)},
    {"metric", "FILE", "learned metric for the scores (the shipped one); `none`: use distances",
     sim_option_text, FIELD(eval.metric)},
    {"cohort", "FILE", "templates that normalise scores; the default is then --metric none",
     sim_option_text, FIELD(eval.cohort)},
};

static int report(const struct sim_eval *eval, const char *out, struct iso_fault *fault)
{
    sim_report_text(eval, stdout);
    sim_contest_left_out(eval, stdout);
    (void)fflush(stdout); /* the next corpus may take a while */
    int error = sim_report_csv(eval, out, fault);
    if (!error) {
        error = sim_report_json(eval, out, fault);
    }
    if (error) {
        return error;
    }
    return sim_report_plots(eval, out, fault);
}

/* Evaluates one corpus. If there are several, the results of each go to a folder of their own. */
static int run_one(const struct arguments *arguments, const char *corpus, struct sim_contest *out,
                   struct iso_fault *fault)
{
    struct sim_eval_options options = arguments->eval;
    struct sim_eval *eval = NULL;
    options.corpus = corpus;
    int error = sim_eval_run(&options, &eval, fault);
    if (!error && sim_contest_of(eval, out)) {
        error = iso_fault_set(fault, -ENOMEM, "%s: out of memory", corpus);
    }
    char own[PATH_MAX];
    const char *directory = arguments->out;
    if (!error && arguments->corpora.n > 1) {
        error = iso_path_join(arguments->out, out->corpus, own, fault);
        if (!error) {
            error = sim_make_directory(own, fault);
        }
        directory = own;
    }
    if (!error) {
        error = report(eval, directory, fault);
    }
    sim_eval_free(eval);
    return error;
}

/* Chooses the shipped metric, which the appliance uses, unless the options ask for distances. */
static void choose_metric(struct sim_eval_options *eval)
{
    if (!eval->metric && !eval->cohort) {
        eval->metric = iso_shipped_metric();
    } else if (eval->metric && strcmp(eval->metric, "none") == 0) {
        eval->metric = NULL;
    }
}

static int run_all(struct arguments *arguments, struct sim_contest *contests,
                   struct iso_fault *fault)
{
    struct sim_training_set *training = NULL;
    const size_t n = arguments->corpora.n;
    int error = sim_make_directory(arguments->out, fault);
    if (!error) {
        error = sim_method_choice_apply(&arguments->choice, arguments->train, &arguments->eval,
                                        &training, fault);
    }
    for (size_t i = 0; i < n && !error; i++) {
        error = run_one(arguments, arguments->corpora.text[i], &contests[i], fault);
    }
    sim_training_set_free(training);
    if (error || (arguments->choice.n < 2 && n < 2)) {
        return error;
    }
    for (size_t i = 0; i < n; i++) {
        sim_contest_text(&contests[i], stdout);
    }
    return sim_contest_csv(contests, n, arguments->out, fault);
}

static int run(void *target, struct iso_fault *fault)
{
    struct arguments *arguments = target;
    if (arguments->corpora.n == 0 || !arguments->out) {
        return iso_fault_set(fault, -EINVAL, "--corpus and --out are needed");
    }
    choose_metric(&arguments->eval);
    if (arguments->eval.threads == 0) {
        arguments->eval.threads = sim_threads_default(arguments->eval.extract.heat);
    }
    struct sim_contest *contests = calloc(arguments->corpora.n, sizeof *contests);
    if (!contests) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    const int error = run_all(arguments, contests, fault);
    free(contests);
    return error;
}

int sim_cmd_eval(int argc, char **argv)
{
    struct arguments arguments = {
        .eval = {.model = iso_shipped_model(),
                 .extract = iso_extract_options_default(),
                 .match = iso_match_options_default()},
    };
    const struct sim_option_set sets[] = {
        {own_options, sizeof own_options / sizeof *own_options, &arguments},
        sim_extract_option_set(&arguments.eval.extract),
        sim_match_option_set(&arguments.eval.match),
    };
    const struct sim_command command = {
        .name = "eval",
        .needs = "--corpus DIR --out DIR",
        .summary =
            "Enrols the gallery of a corpus, searches it for every probe, and writes scores.csv,\n"
            "landmarks.csv, cmc.csv, det.csv, growth.csv, curves.csv, summary.json and plots. "
            "With\n"
            "several methods or corpora it also writes methods.csv, one table of all of them.",
        .run = run,
        .notes = sim_method_choice_help,
    };
    return sim_command_run(&command, sets, sizeof sets / sizeof *sets, argc, argv);
}
