/* What a recogniser can take from a record of the outline stream (firmware/contract/
 * stream_record.h), and, for comparison, from a plain silhouette of the same frame.
 *
 * The features are a window of the silhouette, three mean heads wide, that follows the head in
 * position and size, so that the same person gives the same window wherever he or she stands. */
#ifndef SIM_LAB_OUTLINE_OUTLINE_FEATURES_H
#define SIM_LAB_OUTLINE_OUTLINE_FEATURES_H

#include "firmware/stream/head_outline.h"
#include "isotherm/frame.h"

enum { SIM_OUTLINE_COLUMNS = 36, SIM_OUTLINE_ROWS = 36, SIM_OUTLINE_ANGLES = 32 };

/* What the recogniser sees. */
enum sim_outline_view {
    SIM_OUTLINE_STREAM = 0, /* the record as a client gets it */
    SIM_OUTLINE_NO_FACE,    /* the record as if no face had been found in the frame; the recogniser
                             * knows where the head is all the same */
    SIM_OUTLINE_PLAIN,      /* not sent: whether each of the 80 x 60 points is near */
    SIM_OUTLINE_POSE,       /* the rotation and the distance alone, which `View` tells, too */
    SIM_OUTLINE_VIEWS
};

/* "stream", "no-face", "plain", "pose"; NULL outside. */
const char *sim_outline_view_name(enum sim_outline_view view);

struct sim_outline_features {
    float window[SIM_OUTLINE_ROWS][SIM_OUTLINE_COLUMNS]; /* 0 or 1; beyond the picture 0 */
    float radius[SIM_OUTLINE_ANGLES]; /* STREAM: of the outline from its middle, by its height;
                                       * POSE: see above; else 0 */
};

/* The features of a frame whose face has this pose. Returns false if the outline is too small, or
 * part of it lies behind the camera. */
bool sim_outline_features_of(const struct iso_head_outline *head,
                             const struct iso_rigid *camera_from_face,
                             const struct iso_frame *frame, enum sim_outline_view view,
                             struct sim_outline_features *out);

#endif
