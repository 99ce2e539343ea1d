/* The figures by which fits are judged, summed over the vertices of a model. Internal to core. */
#ifndef ISO_CORE_LANDMARK_POSE_TALLY_H
#define ISO_CORE_LANDMARK_POSE_TALLY_H

#include "core/landmark/meeting.h"
#include "core/landmark/pose_fit.h"

struct iso_pose_tally {
    int count[ISO_MEETINGS];
    double cost_mm2;
};

/* Adds one vertex. distance_mm is used only for ISO_MEETING_MEASURED. */
static inline void iso_pose_tally_add(struct iso_pose_tally *tally, enum iso_meeting meeting,
                                      double distance_mm)
{
    tally->count[meeting]++;
    if (meeting == ISO_MEETING_MEASURED) {
        const double square = distance_mm * distance_mm;
        tally->cost_mm2 += square < ISO_POSE_COST_LIMIT_MM2 ? square : ISO_POSE_COST_LIMIT_MM2;
    }
}

/* Sets the cost, the coverage and the share in the image of a fit. */
static inline void iso_pose_tally_finish(const struct iso_pose_tally *tally,
                                         struct iso_pose_fit *fit)
{
    int measured = tally->count[ISO_MEETING_MEASURED];
    int facing = measured + tally->count[ISO_MEETING_OUTSIDE] +
                 tally->count[ISO_MEETING_UNMEASURED];
    fit->cost_mm2 = measured > 0 ? tally->cost_mm2 / measured : ISO_POSE_COST_LIMIT_MM2;
    fit->coverage = facing > 0 ? (double)measured / facing : 0.0;
    fit->in_image = facing > 0 ? 1.0 - (double)tally->count[ISO_MEETING_OUTSIDE] / facing : 0.0;
}

#endif
