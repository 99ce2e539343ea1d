/* A printed photograph as a depth sensor sees it: a sheet of paper, flat, bent or folded.
 *
 * A sheet bends without stretching: lengths along it stay the same. Its frame: x right, y down,
 * z away from the viewer, the middle of the sheet at the origin. */
#ifndef SIM_WORLD_PROP_SHEET_H
#define SIM_WORLD_PROP_SHEET_H

#include <stdbool.h>

#include "sim/world/prop/solid.h"

enum sim_sheet_shape {
    SIM_SHEET_FLAT = 0,
    SIM_SHEET_ROLLED, /* a cylinder */
    SIM_SHEET_S,      /* one half bent away, the other towards the viewer */
    SIM_SHEET_CREASED /* folded, both halves plane */
};

struct sim_sheet {
    double width_mm, height_mm;
    enum sim_sheet_shape shape;
    double radius_mm;  /* ROLLED: > 0 bends the sides away from the viewer, < 0 towards; S: either
                          sign */
    double crease_rad; /* CREASED: slope of each half, > 0: away from the viewer */
    double axis_rad;   /* angle of the axis or the fold to the vertical */
    bool outline;      /* cut along the outline of a face that fills the sheet */
    double waves_mm;   /* amplitude of the paper's unevenness */
    uint64_t key;      /* of the unevenness */
};

/* Position of the point (x, y) of the flat sheet after bending, without the unevenness. */
struct iso_vec3 sim_sheet_point(const struct sim_sheet *sheet, double x_mm, double y_mm);

/* Makes the sheet as a solid. -EINVAL for a size that is not positive or a radius of 0 where one is
 * needed; -ENOMEM. */
int sim_sheet_new(const struct sim_sheet *sheet, enum sim_material material, struct sim_solid **out)
    __attribute__((warn_unused_result));

#endif
