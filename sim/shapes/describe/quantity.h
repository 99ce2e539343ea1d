/* What `shapes describe` can say about a shape: each quantity by its name. */
#ifndef SIM_SHAPES_DESCRIBE_QUANTITY_H
#define SIM_SHAPES_DESCRIBE_QUANTITY_H

#include <stdbool.h>

#include "isotherm/shape_method.h"
#include "isotherm/signature.h"
#include "sim/shapes/describe/array.h"

enum {
    SIM_QUANTITY_TIMES = 100,
    SIM_QUANTITY_ENERGIES = 100,
    SIM_QUANTITY_VIEWS = 4,
    SIM_QUANTITY_VIEWS_MAX = 16,
};

/* The parameters of all quantities. Times are in the square of the mesh's unit. */
struct sim_quantity_options {
    int times; /* of hks, evenly spaced on a logarithmic scale; 0: SIM_QUANTITY_TIMES */
    double time_first, time_last; /* 0: 4 ln 10 / lambda of the last and of the first pair that
                                   * is not trivial (Sun, Ovsjanikov and Guibas 2009) */
    int energies;                 /* of wks; 0: SIM_QUANTITY_ENERGIES */
    double persistence;           /* of segments: least one of a peak, in ranges of the function */
    int heat_source;              /* of heat: the vertex of the shape where it starts */
    int views;                    /* 0: SIM_QUANTITY_VIEWS */
    enum iso_view_score view_score;
};

struct sim_quantity {
    const char *name;
    const char *help; /* one line, with the arrays' names and sizes */
    /* Appends arrays. -ENOMEM, -EINVAL for parameters that do not fit the shape, -ERANGE for a
     * vertex that the shape does not have and for too many views, -ENOTSUP for what needs a mesh
     * and has a cloud. */
    int (*compute)(const struct iso_shape *shape, const struct sim_quantity_options *options,
                   struct sim_arrays *arrays);
};

/* All quantities except the methods of isotherm/shape_method.h; the table ends with a NULL name. */
extern const struct sim_quantity sim_quantities[];

/* Finds a quantity by its name; NULL if there is none of that name. */
const struct sim_quantity *sim_quantity_find(const char *name);

/* Appends the description by a method: METHOD, the description of the shape as a whole; and of
 * methods with bags METHOD_local, a row of values for each vertex, the bags side by side. -ENODATA
 * for a method that needs colours, -ENOMEM. */
int sim_quantity_method(const struct iso_shape *shape, const struct iso_shape_method *method,
                        struct sim_arrays *arrays) __attribute__((warn_unused_result));

/* Appends what all others refer to: vertices and triangles of the shape, and the area of each
 * vertex. -ENOMEM. */
int sim_quantity_mesh(const struct iso_shape *shape, struct sim_arrays *arrays)
    __attribute__((warn_unused_result));

/* ---- shared by the files of the quantities ---- */

/* The time of the heat mean signature and of segments, in areas of the shape: as for the method TD.
 */
#define SIM_QUANTITY_MEAN_TIME (1.0 / 64.0)

/* Appends an array of doubles whose memory it takes, even after a failure. -ENOMEM. */
int sim_quantity_add(struct sim_arrays *arrays, const char *name, const char *meaning, double *data,
                     int32_t rows, int32_t columns) __attribute__((warn_unused_result));

/* Quantities of the table, as sim_quantity.compute. */
int sim_quantity_segments(const struct iso_shape *shape, const struct sim_quantity_options *options,
                          struct sim_arrays *arrays) __attribute__((warn_unused_result));
int sim_quantity_views(const struct iso_shape *shape, const struct sim_quantity_options *options,
                       struct sim_arrays *arrays) __attribute__((warn_unused_result));

#endif
