/* Decides which hint is given, and when. Thirty frames come in a second, and each has a word of
 * its own; a person can follow one hint at a time, and only if it lasts. Pure: time is an
 * argument.
 *
 * The words of the last frames vote. The word that most frames have (of two equal ones, the newer)
 * becomes the hint if at least `hold` frames have it and the newest frame is one of them. So no
 * hint is given for a fault that is over. At least interval_ns passes between two hints. A hint
 * that still applies is repeated.
 *
 * A usable frame votes for no hint: as long as some frames can be used, the visit makes progress.
 * Frames older than ISO_HINT_AGE_NS do not vote. */
#ifndef ISO_FIRMWARE_VISIT_HINT_FILTER_H
#define ISO_FIRMWARE_VISIT_HINT_FILTER_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/base/times.h"
#include "isotherm/capture.h"

enum { ISO_HINT_FRAMES = 8 };

/* A slow machine takes four seconds for eight frames; those of a fast one are younger. */
#define ISO_HINT_AGE_NS (2 * ISO_NS_PER_S)

struct iso_hint_options {
    int hold; /* 1..ISO_HINT_FRAMES */
    int64_t interval_ns;
};

struct iso_hint_filter {
    struct iso_hint_options options;
    int n_frames; /* how many of `frames` may vote; the newest is the first */
    struct {
        enum iso_capture capture;
        int64_t t_ns;
    } frames[ISO_HINT_FRAMES];
    bool given; /* there was a hint since the reset */
    int64_t given_ns;
};

/* Begins with no votes and no hint. */
void iso_hint_filter_init(struct iso_hint_filter *filter, const struct iso_hint_options *options);

/* Something new begins: no earlier frame votes, and the first hint does not wait for the
 * interval. */
void iso_hint_filter_reset(struct iso_hint_filter *filter);

/* The person has done what a hint asked for (a stage of an enrolment has passed): no earlier frame
 * votes, but the interval after the last hint still applies. */
void iso_hint_filter_forget(struct iso_hint_filter *filter);

/* Handles the word of a frame; t_ns never decreases. Returns the hint to be given now, or
 * ISO_CAPTURE_OK. */
enum iso_capture iso_hint_filter_frame(struct iso_hint_filter *filter, enum iso_capture capture,
                                       int64_t t_ns);

/* The word that wins the votes now, whether or not a hint is due: ISO_CAPTURE_OK if it has fewer
 * than `hold` votes or there are none. For pictures that show all the time what hinders a person.
 */
enum iso_capture iso_hint_filter_word(const struct iso_hint_filter *filter);

#endif
