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
 *          refractory_ns after the verdict             IDLE         none; a new visit may begin
 *   every  reset                                       IDLE         none */
/* clang-format on */
/* A usable face is a frame that gave a template. It counts for the best person of the gallery if
 * the score of that person reaches the threshold and is higher than the score of the second person
 * by the margin. Only frames of one track (track.h) can agree: frames of two faces never do. The
 * oldest of them is at most stale_ns older than the newest.
 *
 * An attack frame is one with a cue of a presentation attack instead of a template. It is evidence
 * against whatever is before the camera, so it still counts when the track changes. A single one
 * may be a mistake: it delays nobody, and it is no visit by itself. In SPENT it only shows that
 * somebody is still there. */
#ifndef ISO_FIRMWARE_VISIT_DECISION_H
#define ISO_FIRMWARE_VISIT_DECISION_H

#include <stdbool.h>
#include <stdint.h>

#include "isotherm/capture.h"

enum { ISO_DECISION_FRAMES_MAX = 64 };

enum iso_reason {
    ISO_REASON_NONE = 0,
    ISO_REASON_MATCH,     /* an enrolled person; the only reason of this file that allows */
    ISO_REASON_UNKNOWN,   /* max_frames frames without agreement */
    ISO_REASON_LEFT,      /* the person left before there was agreement */
    ISO_REASON_NOT_VALID, /* a known person who may not enter at this time */
    ISO_REASON_UNLOGGED,  /* the audit log cannot be written */
    ISO_REASON_ATTACK,    /* a picture, a screen, a mask */
    /* Reasons for which nobody is let in, whatever the face. They replace the reason of the
     * decision: lock-out and lockdown (lockout.h), then faults of the stores. */
    ISO_REASON_LOCKED_OUT,
    ISO_REASON_LOCKDOWN,
    ISO_REASON_NO_GALLERY, /* the gallery is out of service (gallery.h) */
    ISO_REASON_NO_LOCKOUT, /* the lock-out file cannot be read yet */
    /* Reasons that replace an admission after the decision. */
    ISO_REASON_NOT_ON_RECORD, /* the record did not get to the disk in time */
    ISO_REASON_STALE,         /* the frames were too old when the lock was to be switched */
    /* Reasons of the policy (firmware/access/site_access.h). The first two allow, the others
     * replace an admission. */
    ISO_REASON_OPEN,         /* the door is open to everybody at this time */
    ISO_REASON_CREDENTIAL,   /* an enrolled person by card or PIN alone, as the policy permits */
    ISO_REASON_DISABLED,     /* the person's credential is disabled */
    ISO_REASON_NOT_HERE,     /* the person may never enter at this door */
    ISO_REASON_NOT_NOW,      /* the person may enter at other times */
    ISO_REASON_NOT_ENOUGH,   /* a card, a PIN or a second person was wanted and did not come */
    ISO_REASON_WRONG_FACTOR, /* a card of somebody else, or a wrong PIN */
    ISO_REASON_ANTIPASSBACK, /* the person is, as far as is known, inside already */
    ISO_REASON_NO_PAIR,      /* these two people may not enter together */
    ISO_REASON_NO_POLICY,    /* the policy cannot be used, or the date is not known */
    ISO_REASON_NO_LEASE,     /* a person of a fleet, whose hub has not answered for too long */
    ISO_REASON_NOT_APPROVED, /* enrolled at this door, and the hub admits no such people */
    ISO_REASONS
};

/* "none", "match", "unknown", "left", "not-valid", "unlogged", "attack", "locked-out", "lockdown",
 * "no-gallery", "no-lockout", "not-on-record", "stale", "open", "credential", "disabled",
 * "not-here", "not-now", "not-enough", "wrong-factor", "antipassback", "no-pair", "no-policy",
 * "no-lease", "not-approved"; NULL outside. */
const char *iso_reason_name(enum iso_reason reason);

/* All-zero is DENY. */
struct iso_verdict {
    bool allow;
    enum iso_reason reason;
    int64_t person;   /* the person recognised; 0: nobody was certain enough */
    double score;     /* the best score of that person, else of anybody; NaN: there is none */
    int frames;       /* number of usable frames */
    int64_t since_ns; /* if allowed: time of the oldest of the agreeing frames */
    int attack_frames;
    enum iso_capture cue; /* the cue of most attack frames; ISO_CAPTURE_OK: there were none */
    /* From the policy: a second person who enters, too (0: nobody); let in although the person
     * should be inside already. */
    int64_t companion;
    bool passback;
    double threshold; /* that the score had to reach; set where the policy is asked */
};

struct iso_decision_options {
    double threshold, margin;
    int agree, max_frames; /* 1 <= agree <= max_frames <= ISO_DECISION_FRAMES_MAX */
    int attack_frames;     /* 1 or more */
    int64_t gap_ns, refractory_ns;
    int64_t stale_ns; /* frames further apart than this do not agree */
};

/* A usable face. */
struct iso_decision_frame {
    int64_t t_ns;   /* time of the frame; never decreases */
    int64_t person; /* the best person, from 1; 0 if the gallery is empty */
    double score;   /* score of that person; if it is not finite, the frame counts for nobody */
    double second_score; /* score of the second person; -INFINITY if there is none */
    bool valid;          /* that person may enter now */
    uint64_t track;      /* track of the face, from 1 */
};

enum iso_decision_state {
    ISO_DECISION_IDLE = 0,
    ISO_DECISION_VISIT,
    ISO_DECISION_SPENT,
};

struct iso_decision {
    struct iso_decision_options options;
    enum iso_decision_state state;
    int64_t seen_ns;    /* VISIT, SPENT: time of the last usable face or attack frame */
    int64_t verdict_ns; /* SPENT: time of the verdict */
    uint64_t track;     /* VISIT: track of its usable frames, if there are any */
    int n_frames;       /* number of usable frames of this visit */
    struct {
        int64_t person; /* the person for whom the frame counts; 0: nobody */
        double score;
        int64_t t_ns;
    } frames[ISO_DECISION_FRAMES_MAX];
    double best_score; /* of all frames and all people; NaN if there is none */
    int n_attack_frames;
    int by_cue[ISO_CAPTURES];
};

/* Begins in IDLE. */
void iso_decision_init(struct iso_decision *decision, const struct iso_decision_options *options);

/* Sets the threshold for all later frames. Earlier frames are not judged again. */
void iso_decision_set_threshold(struct iso_decision *decision, double threshold);

/* Goes back to IDLE. A visit that has begun is forgotten. */
void iso_decision_reset(struct iso_decision *decision);

/* Something else has brought the verdict about the face that is there, at t_ns: SPENT. */
void iso_decision_spend(struct iso_decision *decision, int64_t t_ns);

/* The four functions below return true and fill in *verdict if there is a verdict. Otherwise
 * *verdict is unchanged. */

/* Tells the decision that the face has this track from now on. Call it before iso_decision_face. */
bool iso_decision_track(struct iso_decision *decision, uint64_t track, struct iso_verdict *verdict);

/* Handles a usable face. Call iso_decision_time with its t_ns, and iso_decision_track with its
 * track, before. */
bool iso_decision_face(struct iso_decision *decision, const struct iso_decision_frame *frame,
                       struct iso_verdict *verdict);

/* Handles an attack frame of time t_ns with this cue (iso_capture_is_attack). Call
 * iso_decision_time before. */
bool iso_decision_attack(struct iso_decision *decision, enum iso_capture cue, int64_t t_ns,
                         struct iso_verdict *verdict);

/* Tells the decision that there were no other frames of either kind until t_ns. */
bool iso_decision_time(struct iso_decision *decision, int64_t t_ns, struct iso_verdict *verdict);

/* The time at which iso_decision_time will have an effect; ISO_NEVER_NS if nothing is due. */
int64_t iso_decision_due_ns(const struct iso_decision *decision);

#endif
