/* The additional requirements of an enrolment for a frame: a template is kept for years, and every
 * later visit is compared with it. Pure. */
#ifndef ISO_FIRMWARE_RECOGNISE_ENROLL_GATE_H
#define ISO_FIRMWARE_RECOGNISE_ENROLL_GATE_H

#include "firmware/recognise/enroll_pose.h"
#include "isotherm/extract.h"

struct iso_enroll_gate {
    enum iso_enroll_pose pose; /* the pose that is asked for */
    struct iso_enroll_angles angles;
    double coverage_min;          /* of the face patch, 0..1; frontal pose */
    double pose_coverage_min;     /* the same of the other poses, which hide a part of it */
    double landmark_coverage_min; /* of the isotherms around each landmark, 0..1 */
    double expression_max;        /* iso_extraction.expression_norm */
    double mouth_max_mm;          /* between the lips of the fitted head */
};

/* For an extraction with ISO_CAPTURE_OK: returns OK, or the most useful hint. Of several faults it
 * names the one to be corrected first: pose, then a covered face, then the expression. A part
 * counts as covered if too little was measured around one of its landmarks. A half of the face
 * counts as covered if that is so for two or more landmarks of that half and none of the other
 * half. The half that a turned head shows less of has to be measured, too. */
enum iso_capture iso_enroll_gate_judge(const struct iso_enroll_gate *gate,
                                       const struct iso_extraction *extraction);

#endif
