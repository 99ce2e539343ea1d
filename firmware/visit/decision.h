/* From the frames of one visit to a verdict. Pure: time is an argument. */
/* clang-format off */
/*   state  what happens                                next state   verdict
 *   -----  ------------------------------------------  -----------  --------------------------------
 *   IDLE   a usable face or an attack frame            VISIT        none, or at once as in VISIT
 *   VISIT  `agree` frames of the same person, and at   SPENT        allow; deny if the person may
 *          least half of the usable ones                            not come in at this time
 *          max_frames usable frames without that       SPENT        deny
 *          `attack_frames` attack frames               SPENT        deny
 *          another face than the one tracked           VISIT, anew  deny if there was a usable
 *                                                                   frame; attack frames still count
 *          no frame of either kind for gap_ns          IDLE         deny if there was a usable frame
 *   SPENT  no frame of either kind for gap_ns          IDLE         none
 *          refractory_ns after the verdict             IDLE         none; whoever stays is the next
 *   every  reset                                       IDLE         none */
/* clang-format on */
/* A usable face is a frame that gave a template. It counts for the best person of the gallery if
 * that one's score reaches the threshold and leads the second person's by the margin. All frames
 * that agree are of one track (track.h): two faces cannot agree with each other's help. The oldest
 * of them is at most stale_ns older than the newest.
 *
 * An attack frame is one with a cue of a presentation attack instead of a template. It is evidence
 * against whatever is before the camera, so that a change of track does not forget it. A single one
 * may be a mistake: it delays nobody, and alone it is no visit. In SPENT it only says that somebody
 * is still there. */
#ifndef ISO_FIRMWARE_VISIT_DECISION_H
#define ISO_FIRMWARE_VISIT_DECISION_H

#include <stdbool.h>
#include <stdint.h>

#include "isotherm/capture.h"

enum { ISO_DECISION_FRAMES_MAX = 64 };

enum iso_reason {
    ISO_REASON_NONE = 0,
    ISO_REASON_MATCH,     /* the only one that allows */
    ISO_REASON_UNKNOWN,   /* max_frames without agreement */
    ISO_REASON_LEFT,      /* gone before there was agreement */
    ISO_REASON_NOT_VALID, /* known, but not at this time */
    ISO_REASON_UNLOGGED,  /* the audit log cannot be written */
    ISO_REASON_ATTACK,    /* a picture, a screen, a mask */
    /* Of the lock-out (lockout.h), which goes before the decision. */
    ISO_REASON_LOCKED_OUT,
    ISO_REASON_LOCKDOWN,
    ISO_REASON_NO_GALLERY, /* the gallery is out of service (gallery.h) */
    ISO_REASON_NO_LOCKOUT, /* the lock-out file cannot be read yet */
    /* Of the door, behind the decision. */
    ISO_REASON_NOT_ON_RECORD, /* the record did not get to the disk in time */
    ISO_REASON_STALE,         /* its frames were too old when the lock was to be switched */
    ISO_REASONS
};

/* "none", "match", "unknown", "left", "not-valid", "unlogged", "attack", "locked-out", "lockdown",
 * "no-gallery", "no-lockout", "not-on-record", "stale"; NULL outside. */
const char *iso_reason_name(enum iso_reason reason);

/* All-zero is DENY. */
struct iso_verdict {
    bool allow;
    enum iso_reason reason;
    int64_t person;   /* whose face it is; 0 if nobody's is sure enough */
    double score;     /* the best one of that person, else of anybody; NaN without any */
    int frames;       /* usable ones */
    int64_t since_ns; /* allowed: time of the oldest of the frames that agree */
    int attack_frames;
    enum iso_capture cue; /* of most of them; ISO_CAPTURE_OK: there were none */
};

struct iso_decision_options {
    double threshold, margin;
    int agree, max_frames; /* 1 <= agree <= max_frames <= ISO_DECISION_FRAMES_MAX */
    int attack_frames;     /* 1 or more */
    int64_t gap_ns, refractory_ns;
    int64_t stale_ns; /* a frame agrees with none that is older than it by more than that */
};

/* A usable face. */
struct iso_decision_frame {
    int64_t t_ns;        /* of the frame; does not fall */
    int64_t person;      /* the best one, from 1; 0 if the gallery is empty */
    double score;        /* of that one; ignored without. Not finite: counts for nobody */
    double second_score; /* of the next person; -INFINITY if there is none */
    bool valid;          /* that person may enter now */
    uint64_t track;      /* of the face, from 1 */
};

enum iso_decision_state {
    ISO_DECISION_IDLE = 0,
    ISO_DECISION_VISIT,
    ISO_DECISION_SPENT,
};

struct iso_decision {
    struct iso_decision_options options;
    enum iso_decision_state state;
    int64_t seen_ns;    /* VISIT, SPENT: the last usable face or attack frame */
    int64_t verdict_ns; /* SPENT: since when */
    uint64_t track;     /* VISIT: of its usable frames, if there are any */
    int n_frames;       /* usable ones of this visit */
    struct {
        int64_t person; /* whom the frame counts for; 0: nobody */
        double score;
        int64_t t_ns;
    } frames[ISO_DECISION_FRAMES_MAX];
    double best_score; /* of all frames and anybody; NaN without any */
    int n_attack_frames;
    int by_cue[ISO_CAPTURES];
};

void iso_decision_init(struct iso_decision *decision, const struct iso_decision_options *options);

/* The threshold for the frames from now on; those before have been judged. */
void iso_decision_set_threshold(struct iso_decision *decision, double threshold);

/* Nobody is there; a visit that has begun is forgotten. */
void iso_decision_reset(struct iso_decision *decision);

/* The four below return true and fill in *verdict if there is one; else *verdict is untouched. */

/* Takes in that the face seen from now on is of this track; before iso_decision_face with it. */
bool iso_decision_track(struct iso_decision *decision, uint64_t track, struct iso_verdict *verdict);

/* Takes a usable face in; iso_decision_time with its t_ns and iso_decision_track with its track
 * come first. */
bool iso_decision_face(struct iso_decision *decision, const struct iso_decision_frame *frame,
                       struct iso_verdict *verdict);

/* Takes an attack frame in: a frame of time t_ns with this cue (iso_capture_is_attack).
 * iso_decision_time comes first. */
bool iso_decision_attack(struct iso_decision *decision, enum iso_capture cue, int64_t t_ns,
                         struct iso_verdict *verdict);

/* Takes in that until t_ns no more of both were there than were told of. */
bool iso_decision_time(struct iso_decision *decision, int64_t t_ns, struct iso_verdict *verdict);

/* When iso_decision_time will do something; ISO_NEVER_NS if nothing is due. */
int64_t iso_decision_due_ns(const struct iso_decision *decision);

#endif
