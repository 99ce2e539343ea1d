/* Shows how far the running command is. One task is shown at a time, and only after main() has said
 * where. In tests, and where the simulator is used as a library, nothing is shown. */
#ifndef SIM_BASE_PROGRESS_H
#define SIM_BASE_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* Progress is shown on `out` from here on, as drivers/terminal/progress.h does it. */
void sim_progress_to(FILE *out);

/* Begins a task of `total` steps (0: their number is not known). False if it is not shown, for
 * example because a task that it is part of is shown already. `what` is kept, not copied. To be
 * called by the thread of the command. */
bool sim_progress_begin(const char *what, uint64_t total);

/* Counts further steps. May be called by any thread; does nothing if nothing is shown. */
void sim_progress_step(uint64_t n);

/* Ends the task; `shown` is what sim_progress_begin() returned. */
void sim_progress_end(bool shown);

/* Results may be printed between these two calls. */
void sim_progress_pause(void);
void sim_progress_resume(void);

#endif
