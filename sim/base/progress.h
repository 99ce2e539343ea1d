/* How far the command of this process is. One thing at a time is shown, and only if main() has said
 * where: as a library, and in tests, the simulator says nothing. */
#ifndef SIM_BASE_PROGRESS_H
#define SIM_BASE_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* Progress is shown on `out` from here on, as drivers/terminal/progress.h does it. */
void sim_progress_to(FILE *out);

/* Begins something of `total` steps (0: nobody can know how many). False if it is not shown,
 * because something that it is part of is, or for another reason. `what` is kept, not copied. To be
 * called by the thread of the command. */
bool sim_progress_begin(const char *what, uint64_t total);

/* So many steps more. From any thread; nothing happens if nothing is shown. */
void sim_progress_step(uint64_t n);

/* Ends what was begun; `shown` is what sim_progress_begin() returned. */
void sim_progress_end(bool shown);

/* Between the two results can be printed. */
void sim_progress_pause(void);
void sim_progress_resume(void);

#endif
