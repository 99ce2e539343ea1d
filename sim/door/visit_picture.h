/* Draws the trace of a visit as a picture. */
#ifndef SIM_DOOR_VISIT_PICTURE_H
#define SIM_DOOR_VISIT_PICTURE_H

#include "firmware/gallery/gallery.h"
#include "sim/door/trace.h"
#include "sim/door/visit.h"

/* Writes the trace as a PNG file (sim/lab/picture/visit.h). The gallery supplies the names of the
 * candidates. -ENOMEM, -EIO. */
int sim_visit_picture(const struct sim_trace *trace, const struct sim_visit *visit,
                      const struct iso_gallery *gallery, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
