/* One visit at the door in one picture. */
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
    const struct iso_vec3 *ibug_mm;     /* [ISO_LANDMARKS_IBUG], likewise */
    double t_s;                         /* since the visitor came */
    bool scored;                        /* else the frame was not compared */
    double score;
    const char *word; /* below the frame: whom it is like, or why it was not used */
};

struct sim_visit_switch {
    double t_s;
    bool active;
};

/* All belongs to the caller. */
struct sim_visit_view {
    const char *title, *subtitle;
    bool allowed;
    int n_frames; /* at most SIM_VISIT_PANELS of them are drawn */
    const struct sim_visit_frame *frames;
    double threshold;
    bool decided;
    double verdict_s, end_s; /* when it was decided; until when the relay was watched */
    int n_switches;          /* the relay is without power before the first */
    const struct sim_visit_switch *switches;
};

/* Draws the verdict; each frame as a relief with the fitted face and its twelve landmarks; the
 * score of each frame below it, against the threshold; and the relay over time. -ENOMEM, -EIO. */
int sim_picture_visit(const struct sim_visit_view *view, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
