/* One enrolment: usable frames of one face become templates to keep, one for each pose. Pure: the
 * given pipeline makes the comparisons, and time is an argument.
 *
 * The steps are the poses of enroll_pose.h, in their order; without `poses` there is the frontal
 * step alone. The frontal template is necessary. Any other pose may be left out: not everybody can
 * turn the head, and the frontal template alone is what an enrolment without poses keeps.
 *
 *   ACTIVE  a frame that agrees with the face            -> ACTIVE, a stage is passed
 *           the last such frame of a step                -> ACTIVE with the next step, or COMPLETED
 *                                                           after the last one, unless
 *             another person of the gallery has this face -> DUPLICATE (unless that is allowed)
 *             else the person of this name has another    -> OTHER_FACE (frontal step)
 *           pose_timeout_ns in a step but the frontal     -> the same, without the pose
 *           `stages` misfits in such a step, or a          -> the same, without the pose
 *             template that is not of the frontal face
 *           `stages` misfits in the frontal step          -> FAILED
 *           attack_frames attack frames since a stage     -> ATTACK
 *           timeout_ns after its start                    -> COMPLETED with the poses that are
 *                                                            complete, or TIMED_OUT without frontal
 *           the last pose is left out, and no frame has    -> TIMED_OUT, or FAILED after misfits
 *             agreed since an attack frame
 *           the sensor is gone                            -> DISCONNECTED
 *
 * A frame agrees with the face if it is similar to the frames of its step before it and to the
 * frontal template. The template of another pose belongs to the frontal face if its score is half
 * way from agree_score to duplicate_score or above. Any other usable frame is a misfit: another
 * face, or a bad registration. It is not used, and the person is told the reason. An attack frame
 * has a cue of a presentation attack and no template; those of one stage count together, also if
 * poses are left out between them. All states but ACTIVE are final, and nothing is to be kept of
 * any but COMPLETED. */
#ifndef ISO_FIRMWARE_RECOGNISE_ENROLMENT_H
#define ISO_FIRMWARE_RECOGNISE_ENROLMENT_H

#include <stdbool.h>
#include <stdint.h>

#include "core/registration/icp.h"
#include "firmware/recognise/enroll_pose.h"
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
    int stages;         /* usable frames of the frontal step, 1..ISO_ENROLMENT_STAGES_MAX */
    bool poses;         /* go on with the other poses */
    int pose_stages;    /* usable frames of each of them, 1..ISO_ENROLMENT_STAGES_MAX */
    double agree_score; /* of a frame with those before it, and of the frontal template with those
                           that the person has already */
    double duplicate_score;  /* the score from which on two people count as the same */
    int attack_frames;       /* 1 or more */
    int64_t timeout_ns;      /* longest enrolment */
    int64_t pose_timeout_ns; /* longest step but the frontal one */
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
    int64_t deadline_ns;       /* of all steps */
    int64_t pose_deadline_ns;  /* of the present step; INT64_MAX for the frontal one */
    enum iso_enroll_pose pose; /* the present step; ISO_ENROLL_POSES after the last one */
    int stage;                 /* number of frames used in all steps */
    int stages;                /* of so many, without the steps that are left out */
    int taken;                 /* number of frames used in the present step */
    int misfits;               /* number in the present step */
    int attack_frames;         /* number since the last stage */
    enum iso_capture cue;      /* cue of the last of them */
    struct iso_template frames[ISO_ENROLMENT_STAGES_MAX]; /* of the present step */
    bool kept[ISO_ENROLL_POSES];                          /* which poses are complete */
    struct iso_template fused[ISO_ENROLL_POSES];          /* their templates */
    struct iso_icp_workspace registration;                /* for the registration of the frames */
    int64_t duplicate_of; /* DUPLICATE: the number of the other person */
};

/* How many steps an enrolment has. */
static inline int iso_enrolment_steps(const struct iso_enrolment *enrolment)
{
    return enrolment->options.poses ? ISO_ENROLL_POSES : 1;
}

/* Begins in ACTIVE, with no frame yet. */
void iso_enrolment_begin(struct iso_enrolment *enrolment,
                         const struct iso_enrolment_options *options, int64_t now_ns);

/* Handles a usable frame in the pose of the present step; only while ACTIVE. *passed: a stage is
 * passed. Otherwise the frame was a misfit, or the last one of a pose that is left out, because its
 * frames have too few points in common or its template does not belong to the face. Check the state
 * after the call. Returns a negative errno if a comparison fails for a reason other than the frame.
 * Such an error ends the enrolment only in the last stage of a step: FAILED. */
int iso_enrolment_frame(struct iso_enrolment *enrolment, const struct iso_template *frame,
                        int64_t now_ns, const struct iso_pipeline *pipeline,
                        const struct iso_enrolment_gallery *gallery, bool *passed)
    __attribute__((warn_unused_result));

/* While ACTIVE: counts a frame with a cue of an attack (iso_capture_is_attack). */
void iso_enrolment_attack(struct iso_enrolment *enrolment, enum iso_capture cue);

/* While ACTIVE: leaves the present step out if its time is over, and ends the enrolment if all its
 * time is. */
void iso_enrolment_time(struct iso_enrolment *enrolment, int64_t now_ns);

/* While ACTIVE: the next time at which iso_enrolment_time() does something. */
int64_t iso_enrolment_due_ns(const struct iso_enrolment *enrolment);

/* While ACTIVE: ends the enrolment because the sensor is gone. */
void iso_enrolment_disconnect(struct iso_enrolment *enrolment);

/* Overwrites all templates (biometric data). */
void iso_enrolment_wipe(struct iso_enrolment *enrolment);

#endif
