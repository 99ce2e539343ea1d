/* A rigid three-dimensional print of a face or a head, as a printer makes it from a scan. */
#ifndef SIM_WORLD_PROP_FACE_PRINT_H
#define SIM_WORLD_PROP_FACE_PRINT_H

#include <stdbool.h>

#include "sim/world/face/ict.h"
#include "sim/world/prop/solid.h"

struct sim_face_print {
    double scale;    /* about the face frame's origin; 1: true size */
    bool whole_head; /* with ears, back and neck; else the face alone, as a mask */
    bool eyes_cut;   /* openings for the eyes of who wears it */
    double opening;  /* of them: half axes as a multiple of half the eye's length */
    double shell_mm; /* how thick the print is; 0: only its outer surface is drawn */
};

/* The print of a head whose surface is `vertices_mm` (sim_person_surface), in its face frame.
 * -EINVAL for a scale that is not positive, -ENOMEM. */
int sim_face_print_new(const struct sim_ict *ict, const struct iso_vec3 *vertices_mm,
                       const struct sim_face_print *print, enum sim_material material,
                       struct sim_solid **out) __attribute__((warn_unused_result));

/* How far `inner` has to be pushed back along z for its face to lie at least `gap_mm` behind the
 * face `outer`, vertex by vertex, both surfaces of the same head model in the face frame; can be
 * negative. */
double sim_face_print_push(const struct iso_vec3 *outer_mm, const struct iso_vec3 *inner_mm,
                           double gap_mm);

#endif
