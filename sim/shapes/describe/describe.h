/* isotherm-sim shapes describe: what is known of single meshes, as arrays for other programs. */
#ifndef SIM_SHAPES_DESCRIBE_DESCRIBE_H
#define SIM_SHAPES_DESCRIBE_DESCRIBE_H

#include "sim/base/options.h"
#include "sim/shapes/describe/quantity.h"
#include "sim/shapes/describe/source.h"

struct sim_describe_options {
    struct sim_option_texts meshes; /* files */
    const char *out;                /* directory, created if it is missing */
    const char *what;               /* names of quantities and methods, or "all", with commas */
    const char *format;             /* npy, csv or mat5 */
    const char *laplacian;          /* of meshes: plain or robust */
    const char *view_score;         /* entropy or divergence */
    struct sim_quantity_options quantity;
    int pairs; /* eigenpairs; 0: ISO_SHAPE_PAIRS */
    int vertices, smooth;
    int neighbours; /* of each point of a cloud; 0: ISO_CLOUD_NEIGHBOURS */
    bool mend, strict, no_pictures;
    int threads;
};

/* Writes for each mesh below OUT/NAME, NAME being the file's name without its ending:
 *
 *   the arrays in the wanted format
 *   parameters.json   the file, the program, every parameter, and each array with its meaning
 *   functions.png     each function of the vertices; without no_pictures
 *   views.png         the best views, if they are wanted; without no_pictures
 *
 * A mesh that cannot be described is named on standard error and left out; with `strict` it ends
 * the command. Prints a line for each mesh. -EINVAL for unknown names, for two meshes of one name
 * and if no mesh is given; errors of the last mesh if none could be described; each with a fault.
 */
int sim_shapes_describe(const struct sim_describe_options *options, FILE *out,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* Prints the names of all quantities and methods, a line each. */
void sim_describe_names(FILE *out);

#endif
