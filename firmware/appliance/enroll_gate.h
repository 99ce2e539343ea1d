/* What an enrolment asks of a frame beyond what recognition does: a template is kept for years and
 * every later visit is compared with it. Pure. */
#ifndef ISO_FIRMWARE_APPLIANCE_ENROLL_GATE_H
#define ISO_FIRMWARE_APPLIANCE_ENROLL_GATE_H

#include "firmware/config/config.h"
#include "isotherm/extract.h"

struct iso_enroll_gate {
    double yaw_max_rad, pitch_max_rad;
    double coverage_min;          /* of the face patch, 0..1 */
    double landmark_coverage_min; /* of the isotherms about each landmark, 0..1 */
    double expression_max;        /* iso_extraction.expression_norm */
    double mouth_max_mm;          /* between the lips of the fitted head */
};

/* What a configuration asks for. */
struct iso_enroll_gate iso_enroll_gate_of(const struct iso_config_enroll *config);

/* For an extraction with ISO_CAPTURE_OK: OK, or the hint that would help. Of several faults the one
 * that has to be mended first: pose, then what covers the face, then the expression. A part is
 * covered if too little was measured about one of its landmarks; a half of the face, if that holds
 * for two landmarks or more of that half and none of the other. */
enum iso_capture iso_enroll_gate_judge(const struct iso_enroll_gate *gate,
                                       const struct iso_extraction *extraction);

#endif
