/* Distorts shapes before they are measured: noise, scale, missing parts, deformations.
 *
 * The noise level is given by the noise-to-signal ratio NSR: the variance of the added noise
 * divided by the variance of the coordinates about their mean (Abdelrahman 2013, section 4.2.4). */
#ifndef SIM_SHAPES_MAKE_DISTORT_H
#define SIM_SHAPES_MAKE_DISTORT_H

#include "sim/base/random.h"
#include "sim/shapes/mesh/mesh_file.h"

enum sim_distortion_kind {
    SIM_DISTORTION_WHITE,   /* normal noise on every coordinate; NSR 0.0001, 0.001, 0.01 */
    SIM_DISTORTION_SHOT,    /* the same energy on one vertex in a hundred */
    SIM_DISTORTION_SCALE,   /* larger or smaller by 1.5, 2, 3 */
    SIM_DISTORTION_MISSING, /* 5, 10, 20 % of the surface around a point is cut away */
    SIM_DISTORTION_STRETCH, /* along a random axis by 1.1, 1.25, 1.5, with constant volume */
    SIM_DISTORTION_BULGE,   /* smoothly swollen and shrunk by 2, 4, 6 % of the coordinates' standard
                               deviation, rms */
    SIM_DISTORTIONS
};

enum { SIM_DISTORTION_LEVELS = 3 };

struct sim_distortion {
    enum sim_distortion_kind kind;
    int level; /* 1..3 */
};

/* "white", "shot", "scale", "missing", "stretch", "bulge"; NULL outside the range. */
const char *sim_distortion_name(enum sim_distortion_kind kind);

/* The value of a level, as listed above: NSR, factor or share. */
double sim_distortion_strength(struct sim_distortion distortion);

/* A sim_option_parser of a struct sim_distortion for texts such as "white:2". -EINVAL. */
int sim_distortion_parse(const char *text, void *field);

/* Changes a mesh in place. The same state of `random` gives the same change. -EINVAL for a level
 * out of range or a mesh of fewer than 4 vertices, -ENOMEM; the mesh is then unchanged. */
int sim_distort(struct sim_distortion distortion, struct sim_random *random,
                struct iso_coloured_mesh *mesh) __attribute__((warn_unused_result));

#endif
