/* Shows the progress of the running command. Only one task is shown at a time, and only after
 * main() has set the output. In tests, and where the simulator is used as a library, no progress
 * is shown. */
#ifndef SIM_BASE_PROGRESS_H
#define SIM_BASE_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* From now on progress is shown on `out` (drivers/terminal/progress.h). */
void sim_progress_to(FILE *out);

/* Begins a task of `total` steps (0: the number is not known). Returns false if the task is not
 * shown, for example because a task that contains it is already shown. `what` is kept, not
 * copied. Call this from the thread of the command. */
bool sim_progress_begin(const char *what, uint64_t total);

/* Counts further steps. Any thread may call it. It does nothing if no task is shown. */
void sim_progress_step(uint64_t n);

/* Ends the task; `shown` is what sim_progress_begin() returned. */
void sim_progress_end(bool shown);

/* The command may print results between these two calls. */
void sim_progress_pause(void);
void sim_progress_resume(void);

#endif
