#include "firmware/visit/hint_filter.h"

#include <string.h>

void iso_hint_filter_init(struct iso_hint_filter *filter, const struct iso_hint_options *options)
{
    *filter = (struct iso_hint_filter){.options = *options};
}

void iso_hint_filter_reset(struct iso_hint_filter *filter)
{
    filter->n_frames = 0;
    filter->given = false;
}

void iso_hint_filter_forget(struct iso_hint_filter *filter)
{
    filter->n_frames = 0;
}

/* Inserts the newest frame at the front, and drops the frames that no longer vote. */
static void note(struct iso_hint_filter *filter, enum iso_capture capture, int64_t t_ns)
{
    const int kept = filter->n_frames < ISO_HINT_FRAMES ? filter->n_frames : ISO_HINT_FRAMES - 1;
    memmove(&filter->frames[1], &filter->frames[0], (size_t)kept * sizeof *filter->frames);
    filter->frames[0].capture = capture;
    filter->frames[0].t_ns = t_ns;
    filter->n_frames = kept + 1;
    while (t_ns - filter->frames[filter->n_frames - 1].t_ns > ISO_HINT_AGE_NS) {
        filter->n_frames--;
    }
}

/* Returns the word with the most votes, and how many it has. */
static enum iso_capture count_votes(const struct iso_hint_filter *filter, int *votes)
{
    int counts[ISO_CAPTURES] = {0};
    enum iso_capture winner = filter->frames[0].capture;
    for (int i = 0; i < filter->n_frames; i++) {
        counts[filter->frames[i].capture]++;
    }
    for (int i = 0; i < filter->n_frames; i++) {
        /* The loop begins with the newest frame, whose word wins a tie. */
        if (counts[filter->frames[i].capture] > counts[winner]) {
            winner = filter->frames[i].capture;
        }
    }
    *votes = counts[winner];
    return winner;
}

enum iso_capture iso_hint_filter_frame(struct iso_hint_filter *filter, enum iso_capture capture,
                                       int64_t t_ns)
{
    int votes = 0;
    note(filter, capture, t_ns);
    const enum iso_capture winner = count_votes(filter, &votes);
    if (winner == ISO_CAPTURE_OK || winner != capture || votes < filter->options.hold) {
        return ISO_CAPTURE_OK;
    }
    if (filter->given && t_ns - filter->given_ns < filter->options.interval_ns) {
        return ISO_CAPTURE_OK;
    }
    filter->given = true;
    filter->given_ns = t_ns;
    return winner;
}

enum iso_capture iso_hint_filter_word(const struct iso_hint_filter *filter)
{
    int votes = 0;
    if (filter->n_frames == 0) {
        return ISO_CAPTURE_OK;
    }
    const enum iso_capture winner = count_votes(filter, &votes);
    return votes < filter->options.hold ? ISO_CAPTURE_OK : winner;
}
