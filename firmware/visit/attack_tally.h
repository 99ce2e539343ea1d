/* The frames that show cues of a presentation attack, gathered into attempts. The audit log gets
 * one record for each attempt, not one for each frame. Pure: time is an argument.
 *
 *   QUIET    a frame with a cue                           -> ATTEMPT
 *   ATTEMPT  a frame with a cue                           -> ATTEMPT, counted
 *            no such frame for quiet_ns                   -> QUIET, the attempt is reported
 *            longest_ns after its first frame             -> QUIET, the attempt is reported
 *            end                                          -> QUIET, the attempt is reported
 *
 * Frames after longest_ns belong to a new attempt. So a picture on the opposite wall makes one
 * record in longest_ns, and does not fill the log. */
#ifndef ISO_FIRMWARE_VISIT_ATTACK_TALLY_H
#define ISO_FIRMWARE_VISIT_ATTACK_TALLY_H

#include <stdbool.h>
#include <stdint.h>

#include "isotherm/capture.h"

struct iso_attack_attempt {
    enum iso_capture cue; /* the one that most of its frames have; of two equal ones, the one that
                             reached this number first */
    int frames;           /* number of frames with any cue */
    int64_t duration_ns;  /* time from the first to the last of them */
};

struct iso_attack_tally {
    int64_t quiet_ns, longest_ns;
    int frames; /* 0: QUIET */
    int by_cue[ISO_CAPTURES];
    enum iso_capture cue;
    int64_t first_ns, last_ns;
};

/* Begins in QUIET. */
void iso_attack_tally_init(struct iso_attack_tally *tally, int64_t quiet_ns, int64_t longest_ns);

/* Counts a frame with a cue. Call iso_attack_tally_time with the time of the frame before. */
void iso_attack_tally_frame(struct iso_attack_tally *tally, enum iso_capture cue, int64_t t_ns);

/* Reports that there were no other such frames until t_ns. Returns true if that ends an attempt;
 * *attempt is then that attempt, otherwise it is unchanged. */
bool iso_attack_tally_time(struct iso_attack_tally *tally, int64_t t_ns,
                           struct iso_attack_attempt *attempt);

/* Ends the attempt that goes on, if there is one. Returns the same as iso_attack_tally_time. */
bool iso_attack_tally_end(struct iso_attack_tally *tally, struct iso_attack_attempt *attempt);

/* The time at which iso_attack_tally_time will have an effect; ISO_NEVER_NS if nothing is due. */
int64_t iso_attack_tally_due_ns(const struct iso_attack_tally *tally);

#endif
