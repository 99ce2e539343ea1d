/* The frames that show cues of a presentation attack, gathered into attempts: what is written into
 * the audit log is one record an attempt, not one a frame. Pure: time comes as an argument.
 *
 *   QUIET    a frame with a cue                           -> ATTEMPT
 *   ATTEMPT  a frame with a cue                           -> ATTEMPT, counted
 *            none for quiet_ns                            -> QUIET, the attempt is told
 *            longest_ns after its first frame             -> QUIET, likewise; what follows is a new
 *                                                            one, so that a picture on the wall
 *                                                            opposite does not fill the log
 *            end                                          -> QUIET, likewise */
#ifndef ISO_FIRMWARE_VISIT_ATTACK_TALLY_H
#define ISO_FIRMWARE_VISIT_ATTACK_TALLY_H

#include <stdbool.h>
#include <stdint.h>

#include "isotherm/capture.h"

struct iso_attack_attempt {
    enum iso_capture cue; /* that most of its frames have; of two, the one that had as many first */
    int frames;           /* with any cue */
    int64_t duration_ns;  /* from the first to the last of them */
};

struct iso_attack_tally {
    int64_t quiet_ns, longest_ns;
    int frames; /* 0: QUIET */
    int by_cue[ISO_CAPTURES];
    enum iso_capture cue;
    int64_t first_ns, last_ns;
};

void iso_attack_tally_init(struct iso_attack_tally *tally, int64_t quiet_ns, int64_t longest_ns);

/* Takes a frame with a cue in; iso_attack_tally_time with its t_ns comes first. */
void iso_attack_tally_frame(struct iso_attack_tally *tally, enum iso_capture cue, int64_t t_ns);

/* Takes in that until t_ns no more were there than were told of. True if that ends an attempt;
 * *attempt is that one then, else untouched. */
bool iso_attack_tally_time(struct iso_attack_tally *tally, int64_t t_ns,
                           struct iso_attack_attempt *attempt);

/* Ends an attempt that goes on, if one does. */
bool iso_attack_tally_end(struct iso_attack_tally *tally, struct iso_attack_attempt *attempt);

/* When iso_attack_tally_time will do something; ISO_NEVER_NS if nothing is due. */
int64_t iso_attack_tally_due_ns(const struct iso_attack_tally *tally);

#endif
