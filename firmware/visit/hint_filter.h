/* Which hint is given, and when: frames come thirty times a second and each has a word of its own;
 * a person can follow one hint at a time, and only one that holds. Pure: time comes as an argument.
 *
 * The words of the last frames vote. The one that most of them have (of two with as many, the one
 * that came last) is given as a hint if at least `hold` frames have it and the newest one is among
 * them: a fault that is mended by now is not told any more. Between two hints there is at least
 * interval_ns, also if they are the same: a hint that goes on is repeated.
 *
 * A usable frame votes too, for no hint: while frames can be used now and then, things go on.
 * Frames that are older than ISO_HINT_AGE_NS do not vote any more. */
#ifndef ISO_FIRMWARE_VISIT_HINT_FILTER_H
#define ISO_FIRMWARE_VISIT_HINT_FILTER_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/base/times.h"
#include "isotherm/capture.h"

enum { ISO_HINT_FRAMES = 8 };

/* Half of a slow machine's eight frames; a fast one's are younger. */
#define ISO_HINT_AGE_NS (2 * ISO_NS_PER_S)

struct iso_hint_options {
    int hold; /* 1..ISO_HINT_FRAMES */
    int64_t interval_ns;
};

struct iso_hint_filter {
    struct iso_hint_options options;
    int n_frames; /* that vote at most: the first of these, the newest first */
    struct {
        enum iso_capture capture;
        int64_t t_ns;
    } frames[ISO_HINT_FRAMES];
    bool given; /* there was a hint since the reset */
    int64_t given_ns;
};

void iso_hint_filter_init(struct iso_hint_filter *filter, const struct iso_hint_options *options);

/* Something new begins: no frame votes, and the first hint need not wait. */
void iso_hint_filter_reset(struct iso_hint_filter *filter);

/* What was asked for has been done (a stage of an enrolment): no frame votes, but the interval to
 * the last hint still holds. */
void iso_hint_filter_forget(struct iso_hint_filter *filter);

/* Takes the word of a frame in; t_ns does not fall. The hint to be given now, or ISO_CAPTURE_OK. */
enum iso_capture iso_hint_filter_frame(struct iso_hint_filter *filter, enum iso_capture capture,
                                       int64_t t_ns);

#endif
