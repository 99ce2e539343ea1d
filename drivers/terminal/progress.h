/* How far a program is with what it does. On a terminal one line that is drawn again and again:
 *
 *     rendering frames  [########............]  40 %, 1 min 20 s left
 *
 * and elsewhere (a pipe, a file, a journal) plain lines: the first after two seconds, then one
 * every ten, and one at the end if there was any before.
 *
 *     isotherm-sim: rendering frames: 40 of 100, 1 min 20 s left
 *
 * Who works only counts; a thread of the progress, which takes no signals, draws five times a
 * second, so that the time goes on while nothing is counted. Every function takes NULL and does
 * nothing with it: no work fails because its progress cannot be shown. */
#ifndef ISO_DRIVERS_TERMINAL_PROGRESS_H
#define ISO_DRIVERS_TERMINAL_PROGRESS_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "core/base/clock.h"

struct iso_progress;

/* Begins to show progress on `out`. `program` and `what` are kept, not copied. `total` is what will
 * be counted, 0 if nobody can know: then only the time that has passed is shown. `clock` NULL: the
 * system's; with another one there is no thread, and the caller calls iso_progress_tick(). NULL for
 * want of memory or threads. End it with iso_progress_end(). */
struct iso_progress *iso_progress_start(FILE *out, const char *program, const char *what,
                                        uint64_t total, const struct iso_clock *clock);

/* So many more are done. From any thread. */
void iso_progress_step(struct iso_progress *progress, uint64_t n);

/* So many of so many are done, in all. From any thread. */
void iso_progress_set(struct iso_progress *progress, uint64_t done, uint64_t total);

/* Between the two the line is gone, so that something else can be printed, by the same thread. */
void iso_progress_pause(struct iso_progress *progress);
void iso_progress_resume(struct iso_progress *progress);

/* Draws what is due now. */
void iso_progress_tick(struct iso_progress *progress);

/* Takes the line from the terminal and releases everything. */
void iso_progress_end(struct iso_progress *progress);

/* What is drawn, as a text. */
struct iso_progress_view {
    const char *what;
    uint64_t done, total; /* total 0: not known */
    int64_t elapsed_ns;
};

/* The line of a terminal of so many columns, which it does not fill to the last one. */
void iso_progress_bar(const struct iso_progress_view *view, unsigned columns, char *text,
                      size_t size);

/* The plain line, without the program's name. */
void iso_progress_line(const struct iso_progress_view *view, char *text, size_t size);

#endif
