/* isotherm-sim replay: plays a corpus to the appliance in this process, on a virtual clock. */
#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "drivers/base/shipped.h"
#include "sim/commands/commands.h"
#include "sim/commands/visit_command.h"
#include "sim/door/rehearsal.h"

struct arguments {
    struct sim_rehearsal_options rehearsal;
    enum iso_level level;
};

static int parse_duplicates(const char *text, void *field)
{
    const bool allow = strcmp(text, "allow") == 0;
    if (!allow && strcmp(text, "refuse") != 0) {
        return -EINVAL;
    }
    *(bool *)field = allow;
    return 0;
}

static int parse_level(const char *text, void *field)
{
    struct arguments *arguments = field;
    for (int i = 0; i < SIM_LEVELS; i++) {
        if (strcmp(text, sim_level_name((enum iso_level)i)) == 0) {
            arguments->level = (enum iso_level)i;
            arguments->rehearsal.level = &arguments->level;
            return 0;
        }
    }
    return -EINVAL;
}

#define FIELD(name) offsetof(struct arguments, name)

static const struct sim_option options[] = {
    {"corpus", "DIR", "recordings and manifest.csv", sim_option_text, FIELD(rehearsal.corpus)},
    {"out", "DIR", "new directory for visits.csv, gallery and log; must not exist", sim_option_text,
     FIELD(rehearsal.state)},
    {"model", "FILE", "head model", sim_option_text, FIELD(rehearsal.model)},
    {"metric", "FILE", "learned metric", sim_option_text, FIELD(rehearsal.metric)},
    {"threshold", "SCORE", "decision.threshold (that of the level)", sim_option_number,
     FIELD(rehearsal.threshold)},
    {"level", "NAME", "convenient, balanced or strict (the configuration's default: balanced)",
     parse_level, 0},
    {"duplicates", "WORD", "people who look like an enrolled person: allow, or refuse (default)",
     parse_duplicates, FIELD(rehearsal.allow_duplicate)},
    {"visit", "RECORDING", "after the enrolments, play only this visit", sim_option_text,
     FIELD(rehearsal.visit)},
    {"picture", "FILE", "draw that visit as PNG: frames, fit, scores and the door's relay",
     sim_option_text, FIELD(rehearsal.picture)},
};

static const char usage[] =
    "Usage: isotherm-sim replay --corpus DIR --out DIR [OPTION...]\n\n"
    "Enrols the gallery of a corpus and plays its visits to the appliance in this process, on "
    "a\nvirtual clock: without a daemon, a bus or waiting times, and with the same verdicts every "
    "time.\nExit status 1: an enrolled person was refused at every visit or admitted under another "
    "name,\nor a stranger was let in.\n";

static bool is_complete(const void *target)
{
    const struct arguments *arguments = target;
    return arguments->rehearsal.corpus && arguments->rehearsal.state &&
           (arguments->rehearsal.visit || !arguments->rehearsal.picture);
}

static int play(const void *target, const struct sim_corpus *corpus, sim_visit_listener *listener,
                void *context, struct sim_visit *visits, size_t *n_visits, struct iso_fault *fault)
{
    const struct arguments *arguments = target;
    return sim_rehearse(&arguments->rehearsal, corpus, listener, context, visits, n_visits, fault);
}

int sim_cmd_replay(int argc, char **argv)
{
    struct arguments arguments = {.rehearsal = {.model = iso_shipped_model(),
                                                .metric = iso_shipped_metric(),
                                                .threshold = NAN}};
    const struct sim_visit_command command = {
        .name = "replay",
        .usage = usage,
        .needed = "--corpus and --out are needed, and --visit with --picture",
        .set = {options, sizeof options / sizeof *options, &arguments},
        .corpus = &arguments.rehearsal.corpus,
        .out = &arguments.rehearsal.state,
        .is_complete = is_complete,
        .play = play,
    };
    return sim_visit_command_run(&command, argc, argv);
}
