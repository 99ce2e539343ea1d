/* Draws one visit at the door as one picture. */
#ifndef SIM_LAB_PICTURE_VISIT_H
#define SIM_LAB_PICTURE_VISIT_H

#include <stdbool.h>

#include "core/base/fault.h"
#include "isotherm/frame.h"
#include "isotherm/landmark.h"

enum { SIM_VISIT_PANELS = 4 };

struct sim_visit_frame {
    const struct iso_frame *frame;
    const struct iso_vec3 *landmark_mm; /* [ISO_LANDMARKS], or NULL: no head was fitted */
    const struct iso_vec3 *ibug_mm;     /* [ISO_LANDMARKS_IBUG], or NULL likewise */
    double t_s;                         /* since the visitor arrived */
    bool scored;                        /* false: the frame was not compared */
    double score;
    const char *word; /* below the frame: the most similar person, or the reason why the frame was
                         not used */
};

struct sim_visit_switch {
    double t_s;  /* since the visitor arrived */
    bool active; /* whether the relay has power from now on */
};

/* The caller owns all of it. */
struct sim_visit_view {
    const char *title, *subtitle;
    bool allowed;
    int n_frames; /* at most SIM_VISIT_PANELS of them are drawn */
    const struct sim_visit_frame *frames;
    double threshold;
    bool decided;
    double verdict_s, end_s; /* time of the verdict; time until which the relay was watched */
    int n_switches;          /* the relay has no power before the first switch */
    const struct sim_visit_switch *switches;
};

/* Draws the verdict; each frame as a relief with the fitted face and its twelve landmarks; below
 * it the frame's score against the threshold; and the relay over time. -ENOMEM, -EIO. */
int sim_picture_visit(const struct sim_visit_view *view, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
