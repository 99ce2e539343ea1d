/* isotherm-sim shapes match: which point of one shape corresponds to which of another one. */
#ifndef SIM_SHAPES_MATCH_MATCH_H
#define SIM_SHAPES_MATCH_MATCH_H

#include <stdio.h>

#include "sim/base/options.h"

struct sim_match_options {
    struct sim_option_texts meshes; /* two meshes or clouds: from, to */
    const char *out;                /* directory, created if it is missing */
    int pairs;                      /* eigenpairs to which ZoomOut goes; 0: ISO_SHAPE_PAIRS */
    int first_pairs;                /* of the first functional map */
    int step;                       /* pairs that each step of ZoomOut adds */
    double weight;                  /* of the commutator with the Laplacians */
    int vertices;                   /* larger meshes are thinned; 0: no thinning */
    int neighbours;                 /* of each point of a cloud; 0: ISO_CLOUD_NEIGHBOURS */
    bool mend;
};

/* Fits a functional map to wave and heat kernel signatures, refines it by ZoomOut
 * (isotherm/correspondence.h), and writes below `out`:
 *
 *   point.npy     for each vertex of the second shape, the vertex of the first one
 *   map.npy       the functional map of these points
 *   from_vertices.npy, from_triangles.npy, to_vertices.npy, to_triangles.npy
 *                 the shapes to whose vertices the numbers refer
 *   match.png     the first shape in colours of its places, the second one in those of its points
 *   match.json    parameters, and errors if they are known
 *
 * Prints one line, and the errors where both meshes were made with `shapes generate --rest`
 * (truth.h). -EINVAL unless there are two meshes and for parameters out of range; errors of the
 * meshes and of writing; each with a fault. */
int sim_shapes_match(const struct sim_match_options *options, FILE *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
