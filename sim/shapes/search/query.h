/* isotherm-sim shapes query: the shapes of an index that are most like a mesh. */
#ifndef SIM_SHAPES_SEARCH_QUERY_H
#define SIM_SHAPES_SEARCH_QUERY_H

#include "sim/base/options.h"
#include "sim/shapes/search/index.h"

struct sim_query_options {
    struct sim_option_texts meshes;
    const char *index; /* directory */
    const char *out;   /* directory for rankings and pictures; NULL: none are written */
    int matches;       /* that are printed and drawn, 1..100 */
    bool mend;         /* as that of the index; one of the two is enough */
};

/* Prints for each mesh the most similar shapes with their distances, by the norm of the index's
 * method. Below `out` it writes
 *
 *   NAME.csv    all shapes of the index by rising distance: rank,distance,file,class
 *   NAME.png    the mesh and its matches
 *
 * NAME is the mesh's file name without its ending. A mesh that is a file of the index finds itself
 * at distance 0; by local-heat, whose distances are differences of rounded squares, below 0.002.
 * -EINVAL without a mesh; errors of the index, of the meshes and of writing; each with a fault. */
int sim_shapes_query(const struct sim_query_options *options, FILE *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
