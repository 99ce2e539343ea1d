#include <inttypes.h>
#include <string.h>

#include "drivers/terminal/columns.h"
#include "drivers/terminal/progress.h"
#include "drivers/terminal/words.h"

enum { BAR_MIN = 4, BAR_MAX = 30, RIGHT_SIZE = 64 };

static const int64_t second_ns = 1000000000;

/* The remaining time at the present speed, in seconds; -1 if it is unknown. */
static int64_t seconds_left(const struct iso_progress_view *view)
{
    if (view->done == 0 || view->done > view->total || view->elapsed_ns < second_ns) {
        return -1;
    }
    const double rate = (double)view->elapsed_ns / (double)view->done;
    return (int64_t)(rate * (double)(view->total - view->done) / (double)second_ns + 0.5);
}

/* Writes a text such as ", 1 min 20 s left", or "". */
static void left_text(const struct iso_progress_view *view, char *text, size_t size)
{
    char duration[ISO_DURATION_SIZE];
    const int64_t left = seconds_left(view);

    text[0] = '\0';
    if (left >= 0) {
        iso_duration_text(left, duration);
        (void)snprintf(text, size, ", %s left", duration);
    }
}

static double share_done(const struct iso_progress_view *view)
{
    return view->done >= view->total ? 1.0 : (double)view->done / (double)view->total;
}

/* The text to the right of the bar. */
static void right_text(const struct iso_progress_view *view, char text[RIGHT_SIZE])
{
    char left[ISO_DURATION_SIZE + 16];

    if (view->total > 0) {
        left_text(view, left, sizeof left);
        (void)snprintf(text, RIGHT_SIZE, "%3d %%%s", (int)(100.0 * share_done(view)), left);
    } else {
        iso_duration_text(view->elapsed_ns / second_ns, text);
    }
}

/* Fills the bar up to the share that is done. If the total is unknown, a block moves along the bar
 * every second. */
static void fill_bar(const struct iso_progress_view *view, unsigned length, char *bar)
{
    const unsigned filled = (unsigned)(share_done(view) * length);
    const unsigned at = (unsigned)(view->elapsed_ns / second_ns % length);

    for (unsigned i = 0; i < length; i++) {
        bar[i] = (view->total > 0 ? i < filled : i == at) ? '#' : '.';
    }
    bar[length] = '\0';
}

void iso_progress_bar(const struct iso_progress_view *view, unsigned columns, char *text,
                      size_t size)
{
    char right[RIGHT_SIZE], bar[BAR_MAX + 1] = "";

    right_text(view, right);
    const size_t taken = iso_columns_of(view->what) + strlen("  []  ") + strlen(right) + 1;
    if (taken + BAR_MIN <= columns) {
        const size_t room = columns - taken;
        fill_bar(view, room < BAR_MAX ? (unsigned)room : BAR_MAX, bar);
        (void)snprintf(text, size, "%s  [%s]  %s", view->what, bar, right);
    } else {
        (void)snprintf(text, size < columns ? size : columns, "%s", right);
    }
}

void iso_progress_line(const struct iso_progress_view *view, char *text, size_t size)
{
    char left[ISO_DURATION_SIZE + 16];

    if (view->total > 0) {
        left_text(view, left, sizeof left);
        (void)snprintf(text, size, "%s: %" PRIu64 " of %" PRIu64 "%s", view->what, view->done,
                       view->total, left);
    } else {
        iso_duration_text(view->elapsed_ns / second_ns, left);
        (void)snprintf(text, size, "%s: %s so far", view->what, left);
    }
}
