/* isotherm-sim outlines: measures whether the outline stream tells people apart. */
#include <errno.h>
#include <stddef.h>
#include <stdio.h>

#include "drivers/base/shipped.h"
#include "sim/base/options.h"
#include "sim/commands/command.h"
#include "sim/commands/commands.h"
#include "sim/lab/outline/outline_study.h"

struct arguments {
    const char *corpus, *model;
};

#define FIELD(name) offsetof(struct arguments, name)

static const struct sim_option own_options[] = {
    {"corpus", "DIR", "recordings and manifest.csv", sim_option_text, FIELD(corpus)},
    {"model", "FILE", "head model", sim_option_text, FIELD(model)},
};

static int run(void *target, struct iso_fault *fault)
{
    const struct arguments *arguments = target;
    struct sim_outline_result results[SIM_OUTLINE_VIEWS];
    if (!arguments->corpus) {
        return iso_fault_set(fault, -EINVAL, "--corpus is needed");
    }
    const int error = sim_outline_study(arguments->corpus, arguments->model, results, fault);
    if (error) {
        return error;
    }
    printf("%zu people, %zu frames learned, %zu frames named; chance %.2f %%\n", results[0].people,
           results[0].learned, results[0].probes, 100.0 / (double)results[0].people);
    for (int view = 0; view < SIM_OUTLINE_VIEWS; view++) {
        const struct sim_outline_result *r = &results[view];
        printf("%-8s named rightly %5.2f %% (%.2f to %.2f)\n",
               sim_outline_view_name((enum sim_outline_view)view), 100.0 * r->rate,
               100.0 * r->interval.low, 100.0 * r->interval.high);
    }
    return 0;
}

int sim_cmd_outlines(int argc, char **argv)
{
    struct arguments arguments = {.model = iso_shipped_model()};
    const struct sim_option_set sets[] = {
        {own_options, sizeof own_options / sizeof *own_options, &arguments},
    };
    const struct sim_command command = {
        .name = "outlines",
        .needs = "--corpus DIR",
        .summary =
            "Makes the records of the outline stream for every frame of a corpus, and lets a\n"
            "recogniser name the people by them: by the records as they are sent, as they\n"
            "would be without a face, and by plain silhouettes, which are not sent.",
        .run = run,
    };
    return sim_command_run(&command, sets, sizeof sets / sizeof *sets, argc, argv);
}
