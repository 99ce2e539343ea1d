/* One enrolment: several usable frames of one face become a template to keep. Pure: comparisons are
 * made by the pipeline it is given, time comes as an argument.
 *
 *   ACTIVE  a frame that agrees with all frames before    -> ACTIVE, a stage is passed
 *           the last one of them, and it is new           -> COMPLETED
 *           the last one, but somebody else looks so      -> DUPLICATE (unless that is allowed)
 *           ... or the person of this name does not       -> OTHER_FACE
 *           as many misfits as there are stages           -> FAILED
 *           attack_frames attack frames since a stage     -> ATTACK
 *           timeout_ns after its start                    -> TIMED_OUT
 *           the sensor is gone                            -> DISCONNECTED
 *
 * A misfit is a usable frame that is not like the ones before it: another face, or a bad
 * registration. It is not taken, and told to the person as what it is. An attack frame has a cue of
 * a presentation attack and no template; those of one stage count together. All states but ACTIVE
 * are final. */
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
    int stages; /* 1..ISO_ENROLMENT_STAGES_MAX */
    double
        agree_score; /* of a frame with every one before it, and with the person's own templates */
    double duplicate_score; /* from which on somebody else is the same person */
    int attack_frames;      /* 1 or more */
    int64_t timeout_ns;
    bool allow_duplicate;
};

/* Whom the new template is compared with. */
struct iso_enrolment_gallery {
    struct iso_candidate_list everybody, own; /* own: the person enrolled, alone */
    int64_t person;                           /* who that is, if already known, else 0 */
};

struct iso_enrolment {
    struct iso_enrolment_options options;
    enum iso_enrolment_state state;
    int64_t deadline_ns;
    int stage; /* frames taken */
    int misfits;
    int attack_frames;    /* since the last stage */
    enum iso_capture cue; /* of the last of them */
    struct iso_template frames[ISO_ENROLMENT_STAGES_MAX];
    struct iso_template fused;             /* COMPLETED: the template to keep */
    struct iso_icp_workspace registration; /* of the frames */
    int64_t duplicate_of;                  /* DUPLICATE: who that is */
};

/* ACTIVE, with no frame yet. */
void iso_enrolment_begin(struct iso_enrolment *enrolment,
                         const struct iso_enrolment_options *options, int64_t now_ns);

/* Takes a usable frame in; only while ACTIVE. *passed: it was taken (else it was a misfit). Look at
 * the state then. Negative errno if a comparison fails for another reason than the frame; that
 * ends nothing, unless it was the last stage: FAILED. */
int iso_enrolment_frame(struct iso_enrolment *enrolment, const struct iso_template *frame,
                        const struct iso_pipeline *pipeline,
                        const struct iso_enrolment_gallery *gallery, bool *passed)
    __attribute__((warn_unused_result));

/* While ACTIVE: takes a frame with a cue of an attack in (iso_capture_is_attack). */
void iso_enrolment_attack(struct iso_enrolment *enrolment, enum iso_capture cue);

/* While ACTIVE: ends it if its time is over. */
void iso_enrolment_time(struct iso_enrolment *enrolment, int64_t now_ns);

/* While ACTIVE: the sensor is gone. */
void iso_enrolment_disconnect(struct iso_enrolment *enrolment);

/* Overwrites all templates (biometric data). */
void iso_enrolment_wipe(struct iso_enrolment *enrolment);

#endif
