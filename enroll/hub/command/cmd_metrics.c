/* metrics: the figures of the fleet. */
#include <stdio.h>

#include "enroll/hub/command/hub_command.h"
#include "enroll/hub/metrics/hub_metrics.h"

static int metrics(struct hub_run *run)
{
    return run->arguments.n_words > 0
               ? hub_metrics_file(&run->store, run->arguments.words[0], &run->fault)
               : hub_metrics_write(&run->store, stdout, &run->fault);
}

const struct hub_command hub_metrics_commands[] = {
    HUB_COMMAND("metrics", "[FILE]",
                "print the figures of the fleet for Prometheus, or write them into a file", 0, 0, 1,
                metrics),
    {.words = NULL},
};
