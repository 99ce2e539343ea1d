/* Makes shapes of files that nobody has prepared, meshes and clouds of points: reads, mends, looks
 * at what would be left out, thins, smooths. Each cause of a failure has a sentence of its own. */
#ifndef SIM_SHAPES_DESCRIBE_SOURCE_H
#define SIM_SHAPES_DESCRIBE_SOURCE_H

#include "core/shape/describe/largest_part.h"
#include "sim/shapes/make/distort.h"
#include "sim/shapes/mesh/mesh_file.h"

/* How a file becomes a mesh or a cloud. All-zero: as it is, except for mending. A cloud can be
 * neither thinned, distorted nor smoothed. */
struct sim_source_options {
    int32_t vertices; /* a larger mesh is thinned to this number; 0: no thinning */
    bool mend; /* accept that more than 1 % of the area, or of a cloud's points, is left out */
    int32_t neighbours;                      /* of each point of a cloud; 0: ISO_CLOUD_NEIGHBOURS */
    const struct sim_distortion *distortion; /* NULL: no distortion */
    uint64_t seed;                           /* of the distortion, with the file's name */
    int smooth;                              /* double steps of the smoothing filter, at the end */
};

/* Which finite elements a shape has: those of its mesh (isotherm/shape.h, iso_shape_new()), or
 * those for bad meshes (iso_shape_new_robust()). */
enum sim_laplacian { SIM_LAPLACIAN_PLAIN, SIM_LAPLACIAN_ROBUST };

/* What was found in a file. */
struct sim_source_look {
    int32_t points;          /* of a cloud, after those at one place were merged; 0 for a mesh */
    int32_t points_left_out; /* of these, because they are not joined to the largest part */
    struct iso_mesh_mended mended;
    struct iso_part_survey part; /* of the mended mesh, or of the triangles of a cloud's points */
    bool colours;
};

/* Refuses a number of neighbours that is neither 0 nor in the range of the library. -EINVAL. */
int sim_neighbours_check(int neighbours, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads a file, mends it and looks at it. -EBADMSG also for a mesh without area, and for a mesh or
 * a cloud of which more than 1 % of the area or of the points is left out without options->mend;
 * -ENODATA if its largest part has too few vertices; errors of iso_mesh_or_cloud_file_read; each
 * with a fault that names the file. */
int sim_source_look(const char *path, const struct sim_source_options *options,
                    struct sim_source_look *look, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* What was left out: the share of the area, or of the points of a cloud. */
double sim_source_loss(const struct sim_source_look *look);

/* Adds what is known of a cloud when its shape was made to what was found in its file. */
void sim_source_look_at_shape(struct sim_source_look *look, const struct iso_shape *shape);

/* Writes what was left out and mended into a text, or an empty text if it was nothing: "2 parts
 * left out: 0.3 % of the area, 812 vertices; 14 vertices merged". */
void sim_source_left_out(const struct sim_source_look *look, char *text, size_t size);

/* Reads, mends, thins, distorts and smooths a mesh. `name` is the file's name in its corpus, from
 * which the distortion's random numbers come. `look` may be NULL; of a cloud, whose triangles are
 * not made yet, it lacks the part and the points that are left out. -ENOTSUP if over a twentieth
 * more vertices are left than wanted, because the mesh cannot be thinned further; errors of
 * sim_source_look, sim_distort and sim_smooth; each with a fault that names the file. A
 * cloud is read as a mesh without triangles; -ENOTSUP if it should be changed. */
int sim_source_read(const char *path, const char *name, const struct sim_source_options *options,
                    struct sim_source_look *look, struct iso_coloured_mesh *out,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

/* How a mesh or a cloud becomes a shape. */
struct sim_shape_options {
    enum sim_laplacian laplacian; /* of a mesh */
    int32_t neighbours;           /* of each point of a cloud; 0: ISO_CLOUD_NEIGHBOURS */
    bool colours, mend;
    int32_t n_pairs; /* as in iso_shape_new() */
};

/* Makes a shape of a mesh, or of a cloud if it has no triangles. `path` stands for it in faults.
 * -ENODATA if colours are wanted and there are none; -EBADMSG for a cloud of which more than 1 % of
 * the places are not in the shape, without `mend`; errors of iso_shape_new, iso_shape_new_robust or
 * iso_shape_new_cloud; each with a fault. */
int sim_source_shape(const char *path, const struct iso_coloured_mesh *mesh,
                     const struct sim_shape_options *options, struct iso_shape **out,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
