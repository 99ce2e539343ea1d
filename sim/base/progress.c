#include "sim/base/progress.h"

#include "drivers/terminal/progress.h"

static FILE *stream;                  /* NULL: progress is not shown */
static struct iso_progress *progress; /* NULL: no task has begun */

void sim_progress_to(FILE *out)
{
    stream = out;
}

bool sim_progress_begin(const char *what, uint64_t total)
{
    if (!stream || progress) {
        return false;
    }
    progress = iso_progress_start(stream, "isotherm-sim", what, total, NULL);
    return progress;
}

void sim_progress_step(uint64_t n)
{
    iso_progress_step(progress, n);
}

void sim_progress_end(bool shown)
{
    if (shown) {
        iso_progress_end(progress);
        progress = NULL;
    }
}

void sim_progress_pause(void)
{
    iso_progress_pause(progress);
}

void sim_progress_resume(void)
{
    iso_progress_resume(progress);
}
