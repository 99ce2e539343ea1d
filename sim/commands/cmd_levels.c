/* isotherm-sim levels: counts the visits in which people are refused and admitted at each security
 * level. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"
#include "drivers/base/shipped.h"
#include "drivers/terminal/words.h"
#include "sim/base/make_directory.h"
#include "sim/commands/command.h"
#include "sim/commands/commands.h"
#include "sim/door/level_report.h"
#include "sim/door/visit_report.h"
#include "sim/lab/measure/rate.h"

/* The level `balanced` may admit strangers in at most this share of their visits. */
static const double strangers_max = 0.001;

/* The settings of `[match] adapt` to measure. */
enum { AS_SHIPPED, ADAPTED, SETTINGS };
enum adapt { ADAPT_NO, ADAPT_YES, ADAPT_BOTH };

/* The counts of all levels with each setting. */
struct counts {
    struct sim_level_counts of[SETTINGS][SIM_LEVELS];
};

struct arguments {
    struct sim_option_texts people, alike;
    enum adapt adapt;
    const char *out, *model, *metric;
    struct sim_rate strangers; /* result: visits of strangers admitted at `balanced`, by the first
                                  setting */
    size_t not_enrolled[2];    /* result: people of each crowd who could not be enrolled */
};

#define FIELD(name) offsetof(struct arguments, name)

static int parse_adapt(const char *text, void *field)
{
    static const char *const names[] = {
        [ADAPT_NO] = "no", [ADAPT_YES] = "yes", [ADAPT_BOTH] = "both"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (strcmp(text, names[i]) == 0) {
            *(enum adapt *)field = (enum adapt)i;
            return 0;
        }
    }
    return -EINVAL;
}

static const struct sim_option options[] = {
    {"corpus", "DIR", "enrolled people and strangers; may be repeated", sim_option_list,
     FIELD(people)},
    {"alike", "DIR", "strangers who look like those enrolled (preset hard); may be repeated",
     sim_option_list, FIELD(alike)},
    {"out", "DIR", "new directory for levels.csv and the visits; must not exist", sim_option_text,
     FIELD(out)},
    {"adapt", "no|yes|both", "[match] adapt of the appliances; `both`: side by side (no)",
     parse_adapt, FIELD(adapt)},
    {"model", "FILE", "head model", sim_option_text, FIELD(model)},
    {"metric", "FILE", "learned metric", sim_option_text, FIELD(metric)},
};

static void ignore_visit(const struct sim_visit *visit, void *context)
{
    (void)visit;
    (void)context;
}

static bool is_measured(enum adapt adapt, int setting)
{
    return adapt == ADAPT_BOTH || (int)adapt == setting;
}

/* Writes visits.csv of each door to the door's folder and adds its visits to `counts`. */
static int take_visits(enum adapt adapt, enum sim_level_crowd crowd, const char *state,
                       const struct sim_visit *visits, size_t n_rows, size_t n_visits,
                       struct counts *counts, struct iso_fault *fault)
{
    int error = 0;
    const struct sim_visit *own = visits;
    for (int door = 0; door < SIM_DOORS_MAX && !error; door++) {
        const int setting = door / SIM_LEVELS, level = door % SIM_LEVELS;
        char name[64], folder[PATH_MAX];
        if (!is_measured(adapt, setting)) {
            continue;
        }
        (void)snprintf(name, sizeof name, "%s%s", sim_level_name((enum iso_level)level),
                       adapt == ADAPT_BOTH && setting == ADAPTED ? "-adapted" : "");
        error = iso_path_join(state, name, folder, fault);
        if (!error) {
            error = sim_visit_write_csv(folder, own, n_visits, fault);
        }
        sim_level_count(crowd, own, n_visits, &counts->of[setting][level]);
        own += n_rows;
    }
    return error;
}

static int play_visits(enum adapt adapt, const struct sim_rehearsal_options *rehearsal,
                       enum sim_level_crowd crowd, const struct sim_corpus *corpus,
                       struct counts *counts, struct iso_fault *fault)
{
    size_t n_visits = 0;
    struct sim_visit *visits = calloc(SIM_DOORS_MAX * corpus->n_rows, sizeof *visits);
    if (!visits) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    int error = sim_rehearse(rehearsal, corpus, ignore_visit, NULL, visits, &n_visits, fault);
    if (!error) {
        error = take_visits(adapt, crowd, rehearsal->state, visits, corpus->n_rows, n_visits,
                            counts, fault);
    }
    free(visits);
    return error;
}

/* Plays one corpus. Its galleries, logs and visits go to a numbered folder of the output. */
static int play_corpus(struct arguments *arguments, enum sim_level_crowd crowd,
                       const char *directory, size_t number, struct counts *counts,
                       struct iso_fault *fault)
{
    char name[32], state[PATH_MAX];
    const struct sim_rehearsal_options rehearsal = {
        .corpus = directory,
        .state = state,
        .model = arguments->model,
        .metric = arguments->metric,
        .threshold = NAN,
        .all_levels = true,
        .adapt = arguments->adapt == ADAPT_YES,
        .adapt_too = arguments->adapt == ADAPT_BOTH,
        .allow_duplicate = true, /* among many people some look alike; they are enrolled too */
        .not_enrolled = &arguments->not_enrolled[crowd],
    };
    struct sim_corpus *corpus = NULL;
    (void)snprintf(name, sizeof name, "%s-%zu", crowd == SIM_CROWD_ALIKE ? "alike" : "people",
                   number);
    int error = iso_path_join(arguments->out, name, state, fault);
    if (!error) {
        error = sim_corpus_read(directory, &corpus, fault);
    }
    if (!error) {
        error = sim_make_new_directory(state, fault);
    }
    if (!error) {
        error = play_visits(arguments->adapt, &rehearsal, crowd, corpus, counts, fault);
    }
    sim_corpus_free(corpus);
    return error;
}

static int write_files(const struct arguments *arguments, const struct counts *counts,
                       struct iso_fault *fault)
{
    static const char *const names[SETTINGS] = {"levels.csv", "levels-adapted.csv"};
    int error = 0;
    for (int setting = 0; setting < SETTINGS && !error; setting++) {
        if (is_measured(arguments->adapt, setting)) {
            error = sim_level_write_csv(arguments->out, names[setting], counts->of[setting], fault);
        }
    }
    return error;
}

static int play_corpora(struct arguments *arguments, enum sim_level_crowd crowd,
                        const struct sim_option_texts *corpora, struct counts *counts,
                        struct iso_fault *fault)
{
    int error = 0;
    for (size_t i = 0; i < corpora->n && !error; i++) {
        error = play_corpus(arguments, crowd, corpora->text[i], i + 1, counts, fault);
        /* The results so far, in case a long run is ended early. */
        if (!error) {
            error = write_files(arguments, counts, fault);
        }
    }
    return error;
}

static int run(void *target, struct iso_fault *fault)
{
    struct arguments *arguments = target;
    static const char *const labels[SETTINGS] = {"", ", adapted"};
    struct counts counts = {0};
    if (arguments->people.n + arguments->alike.n == 0 || !arguments->out) {
        return iso_fault_set(fault, -EINVAL, "--corpus or --alike, and --out are needed");
    }
    int error = sim_make_new_directory(arguments->out, fault);
    if (error) {
        return error;
    }
    error = play_corpora(arguments, SIM_CROWD_PEOPLE, &arguments->people, &counts, fault);
    if (!error) {
        error = play_corpora(arguments, SIM_CROWD_ALIKE, &arguments->alike, &counts, fault);
    }
    if (error) {
        return error;
    }
    sim_level_print_head(stdout);
    for (int setting = 0; setting < SETTINGS; setting++) {
        if (is_measured(arguments->adapt, setting)) {
            sim_level_print(counts.of[setting], labels[setting], stdout);
        }
    }
    const size_t absent = arguments->not_enrolled[SIM_CROWD_PEOPLE];
    if (absent > 0) {
        printf("\n%zu %s could not be enrolled: each of their visits counts as refused.\n", absent,
               iso_plural(absent, "person", "people"));
    }
    const int first = arguments->adapt == ADAPT_YES ? ADAPTED : AS_SHIPPED;
    const struct iso_people_rate *strangers = &counts.of[first][ISO_LEVEL_BALANCED].strangers;
    arguments->strangers = (struct sim_rate){strangers->errors, strangers->trials};
    return 0;
}

int sim_cmd_levels(int argc, char **argv)
{
    struct arguments arguments = {.model = iso_shipped_model(), .metric = iso_shipped_metric()};
    const struct sim_option_set set = {options, sizeof options / sizeof *options, &arguments};
    const struct sim_command command = {
        .name = "levels",
        .needs = "--corpus DIR --alike DIR --out DIR",
        .summary =
            "Counts the visits in which people are refused and let in at each security level.\n"
            "Every visitor stands before three appliances at once, one of each level, on a\n"
            "virtual clock; with --adapt both, before three more that adapt the metric to the\n"
            "enrolled people. The intervals take people, not visits, as independent. Exit status "
            "1: balanced let strangers in at more than 0.1 % of their\n"
            "visits.",
        .run = run,
    };
    const int exit_code = sim_command_run(&command, &set, 1, argc, argv);
    if (exit_code != SIM_EXIT_OK || !(sim_rate_value(arguments.strangers) > strangers_max)) {
        return exit_code;
    }
    fprintf(stderr,
            "isotherm-sim levels: balanced let strangers in at %zu of %zu visits, more than "
            "%.1f %%\n",
            arguments.strangers.events, arguments.strangers.trials, 100.0 * strangers_max);
    return SIM_EXIT_NO_MATCH;
}
