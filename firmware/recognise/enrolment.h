/* One enrolment: several usable frames of one face become a template to keep. Pure: the given
 * pipeline makes the comparisons, and time is an argument.
 *
 *   ACTIVE  a frame that agrees with all frames before    -> ACTIVE, a stage is passed
 *           such a frame in the last stage                -> COMPLETED, unless
 *             another person of the gallery has this face -> DUPLICATE (unless that is allowed)
 *             else the person of this name has another    -> OTHER_FACE
 *           as many misfits as there are stages           -> FAILED
 *           attack_frames attack frames since a stage     -> ATTACK
 *           timeout_ns after its start                    -> TIMED_OUT
 *           the sensor is gone                            -> DISCONNECTED
 *
 * A misfit is a usable frame that is not similar to the frames before it: another face, or a bad
 * registration. It is not used, and the person is told the reason. An attack frame has a cue of a
 * presentation attack and no template; those of one stage count together. All states but ACTIVE are
 * final. */
#ifndef ISO_FIRMWARE_RECOGNISE_ENROLMENT_H
#define ISO_FIRMWARE_RECOGNISE_ENROLMENT_H

#include <stdbool.h>
#include <stdint.h>

#include "core/registration/icp.h"
#include "firmware/recognise/pipeline.h"
#include "isotherm/template.h"

enum { ISO_ENROLMENT_STAGES_MAX = 16 };

enum iso_enrolment_state {
    ISO_ENROLMENT_ACTIVE = 0,
    ISO_ENROLMENT_COMPLETED,
    ISO_ENROLMENT_DUPLICATE,
    ISO_ENROLMENT_FAILED,
    ISO_ENROLMENT_TIMED_OUT,
    ISO_ENROLMENT_DISCONNECTED,
    ISO_ENROLMENT_ATTACK,
    ISO_ENROLMENT_OTHER_FACE,
};

struct iso_enrolment_options {
    int stages;         /* 1..ISO_ENROLMENT_STAGES_MAX */
    double agree_score; /* of a frame with every frame before it, and of the new template with those
                           that the person has already */
    double duplicate_score; /* the score from which on two people count as the same */
    int attack_frames;      /* 1 or more */
    int64_t timeout_ns;
    bool allow_duplicate;
};

/* The people with whom the new template is compared. */
struct iso_enrolment_gallery {
    struct iso_candidate_list everybody, own; /* own: only the person who is enrolled */
    int64_t person;                           /* number of that person if known already, else 0 */
};

struct iso_enrolment {
    struct iso_enrolment_options options;
    enum iso_enrolment_state state;
    int64_t deadline_ns;
    int stage; /* number of frames used */
    int misfits;
    int attack_frames;    /* number since the last stage */
    enum iso_capture cue; /* cue of the last of them */
    struct iso_template frames[ISO_ENROLMENT_STAGES_MAX];
    struct iso_template fused; /* the template made of all frames; COMPLETED: to be kept */
    struct iso_icp_workspace registration; /* for the registration of the frames */
    int64_t duplicate_of;                  /* DUPLICATE: the number of the other person */
};

/* Begins in ACTIVE, with no frame yet. */
void iso_enrolment_begin(struct iso_enrolment *enrolment,
                         const struct iso_enrolment_options *options, int64_t now_ns);

/* Handles a usable frame; only while ACTIVE. *passed: the frame was used (otherwise it was a
 * misfit). Check the state after the call. Returns a negative errno if a comparison fails for a
 * reason other than the frame. Such an error ends the enrolment only in the last stage: FAILED. */
int iso_enrolment_frame(struct iso_enrolment *enrolment, const struct iso_template *frame,
                        const struct iso_pipeline *pipeline,
                        const struct iso_enrolment_gallery *gallery, bool *passed)
    __attribute__((warn_unused_result));

/* While ACTIVE: counts a frame with a cue of an attack (iso_capture_is_attack). */
void iso_enrolment_attack(struct iso_enrolment *enrolment, enum iso_capture cue);

/* While ACTIVE: ends the enrolment if its time is over. */
void iso_enrolment_time(struct iso_enrolment *enrolment, int64_t now_ns);

/* While ACTIVE: ends the enrolment because the sensor is gone. */
void iso_enrolment_disconnect(struct iso_enrolment *enrolment);

/* Overwrites all templates (biometric data). */
void iso_enrolment_wipe(struct iso_enrolment *enrolment);

#endif
