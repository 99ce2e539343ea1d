/* A rigid three-dimensional print of a face or a head, made by a printer from a scan. */
#ifndef SIM_WORLD_PROP_FACE_PRINT_H
#define SIM_WORLD_PROP_FACE_PRINT_H

#include <stdbool.h>

#include "sim/world/face/ict.h"
#include "sim/world/prop/solid.h"

struct sim_face_print {
    double scale;    /* about the face frame's origin; 1: true size */
    bool whole_head; /* with ears, back and neck; otherwise a mask of the face alone */
    bool eyes_cut;   /* the mask has openings for the wearer's eyes */
    double opening;  /* half width of these openings in units of half the eye's length */
    double shell_mm; /* thickness of the print; 0: only its outer surface is drawn */
};

/* The print of a head whose surface is `vertices_mm` (sim_person_surface), in its face frame.
 * -EINVAL for a scale, or for openings, that are not positive; -ENOMEM. */
int sim_face_print_new(const struct sim_ict *ict, const struct iso_vec3 *vertices_mm,
                       const struct sim_face_print *print, enum sim_material material,
                       struct sim_solid **out) __attribute__((warn_unused_result));

/* The distance along z by which `inner` has to be pushed back so that its face lies at least
 * `gap_mm` behind the face `outer` at each vertex. Both are surfaces of the same head model in
 * the face frame. The result can be negative. */
double sim_face_print_push(const struct iso_vec3 *outer_mm, const struct iso_vec3 *inner_mm,
                           double gap_mm);

#endif
