/* Shows the progress of a program. On a terminal it is one line that is redrawn:
 *
 *     rendering frames  [########............]  40 %, 1 min 20 s left
 *
 * Elsewhere (a pipe, a file, a journal) it is plain lines: the first after two seconds, then one
 * every ten seconds, and one at the end if there was one before.
 *
 *     isotherm-sim: rendering frames: 40 of 100, 1 min 20 s left
 *
 * The working thread only counts. A thread of its own, which takes no signals, draws five times a
 * second, so that the time advances while nothing is counted. Every function accepts NULL and then
 * does nothing: no work fails because its progress cannot be shown. */
#ifndef ISO_DRIVERS_TERMINAL_PROGRESS_H
#define ISO_DRIVERS_TERMINAL_PROGRESS_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "core/base/clock.h"

struct iso_progress;

/* Begins to show progress on `out`. `program` and `what` are kept, not copied. `total` is the
 * number of steps; if it is unknown (0), only the time that has passed is shown. If `clock` is
 * NULL, the system's clock is used; with another clock there is no thread, and the caller calls
 * iso_progress_tick(). Returns NULL if there is no memory or no thread. End it with
 * iso_progress_end(). */
struct iso_progress *iso_progress_start(FILE *out, const char *program, const char *what,
                                        uint64_t total, const struct iso_clock *clock);

/* Adds n steps. From any thread. */
void iso_progress_step(struct iso_progress *progress, uint64_t n);

/* Sets the number of steps done, and of all steps. From any thread. */
void iso_progress_set(struct iso_progress *progress, uint64_t done, uint64_t total);

/* Between pause and resume the line is removed, so that the same thread can print something else.
 * In between that thread must not call another function of this header, because a lock is held;
 * other threads wait.
 */
void iso_progress_pause(struct iso_progress *progress);
void iso_progress_resume(struct iso_progress *progress);

/* Draws what is due now. */
void iso_progress_tick(struct iso_progress *progress);

/* Removes the line from the terminal and releases everything. */
void iso_progress_end(struct iso_progress *progress);

/* What is drawn, as a text. */
struct iso_progress_view {
    const char *what;
    uint64_t done, total; /* total 0: not known */
    int64_t elapsed_ns;
};

/* The line for a terminal of this width; it leaves the last column free. */
void iso_progress_bar(const struct iso_progress_view *view, unsigned columns, char *text,
                      size_t size);

/* The plain line, without the program's name. */
void iso_progress_line(const struct iso_progress_view *view, char *text, size_t size);

#endif
