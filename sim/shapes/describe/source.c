#include "sim/shapes/describe/source.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "drivers/terminal/words.h"
#include "sim/shapes/make/smooth.h"
#include "sim/shapes/make/thin.h"
#include "sim/train/head/decimate.h"

/* The share of the area that may be left out without being asked for. */
static const double least_loss = 0.01;

static double loss_of(const struct iso_part_survey *part)
{
    return part->area_left_out / (part->area + part->area_left_out);
}

double sim_source_loss(const struct sim_source_look *look)
{
    return look->points > 0 ? (double)look->points_left_out / look->points : loss_of(&look->part);
}

void sim_source_look_at_shape(struct sim_source_look *look, const struct iso_shape *shape)
{
    look->points_left_out = shape->is_cloud ? look->points - shape->mesh->n_vertices : 0;
}

static int judge(const char *path, bool mend, const struct iso_part_survey *part,
                 struct iso_fault *fault)
{
    if (part->n_triangles == 0) {
        return iso_fault_set(fault, -EBADMSG, "%s: none of its %d triangles has an area", path,
                             part->flat_triangles);
    }
    if (part->n_vertices < ISO_SHAPE_VERTICES_MIN) {
        return iso_fault_set(fault, -ENODATA, "%s: its largest part has %d vertices, %d are needed",
                             path, part->n_vertices, (int)ISO_SHAPE_VERTICES_MIN);
    }
    if (!mend && loss_of(part) > least_loss) {
        return iso_fault_set(fault, -EBADMSG,
                             "%s: of its %d parts only the largest is used, which leaves out "
                             "%.1f %% of the area and %d vertices; --mend accepts this",
                             path, part->n_parts, 100.0 * loss_of(part), part->vertices_left_out);
    }
    return 0;
}

static int look_at_mesh(const char *path, bool mend, const struct iso_coloured_mesh *mesh,
                        struct sim_source_look *seen, struct iso_fault *fault)
{
    if (iso_mesh_check(mesh->mesh, NULL)) {
        return iso_fault_set(fault, -EBADMSG, "%s: a coordinate is not finite", path);
    }
    if (iso_part_survey(mesh->mesh, &seen->part)) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    seen->colours = mesh->colour != NULL;
    return judge(path, mend, &seen->part, fault);
}

static int refuse_cloud(const char *path, int32_t left, int32_t points, struct iso_fault *fault)
{
    return iso_fault_set(fault, -EBADMSG,
                         "%s: %d of its %d points are not joined to the largest part; --mend "
                         "accepts this, triangles from more neighbours may join them",
                         path, left, points);
}

/* Finds which points would be left out, which only the triangles tell. */
static int look_at_cloud(const char *path, const struct sim_source_options *options,
                         const struct iso_mesh *points, struct sim_source_look *seen,
                         struct iso_fault *fault)
{
    struct iso_mesh *cloud = NULL;
    if (iso_mesh_check(points, NULL)) {
        return iso_fault_set(fault, -EBADMSG, "%s: a coordinate is not finite", path);
    }
    int error = iso_cloud_triangulate(points->vertices_mm, points->n_vertices, options->neighbours,
                                      &cloud);
    if (!error) {
        error = iso_part_survey(cloud, &seen->part);
    }
    iso_mesh_free(cloud);
    if (error) {
        return iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
    }
    seen->points_left_out = seen->part.vertices_left_out;
    if (seen->part.n_vertices < ISO_SHAPE_VERTICES_MIN) {
        return iso_fault_set(fault, -ENODATA, "%s: its largest part has %d points, %d are needed",
                             path, seen->part.n_vertices, (int)ISO_SHAPE_VERTICES_MIN);
    }
    return !options->mend && seen->points_left_out > least_loss * seen->points
               ? refuse_cloud(path, seen->points_left_out, seen->points, fault)
               : 0;
}

/* Reads a mesh or a cloud, and looks at a mesh. */
static int read_any(const char *path, bool mend, struct sim_source_look *look,
                    struct iso_coloured_mesh *out, struct iso_fault *fault)
{
    struct iso_coloured_mesh mesh = {NULL, NULL};
    struct sim_source_look seen = {.points = 0};
    int error = iso_mesh_or_cloud_file_read(path, &mesh, &seen.mended, fault);
    if (error) {
        return error;
    }
    seen.colours = mesh.colour != NULL;
    if (mesh.mesh->n_triangles > 0) {
        error = look_at_mesh(path, mend, &mesh, &seen, fault);
    } else {
        seen.points = mesh.mesh->n_vertices;
    }
    if (error) {
        iso_coloured_mesh_done(&mesh);
        return error;
    }
    *look = seen;
    *out = mesh;
    return 0;
}

int sim_neighbours_check(int neighbours, struct iso_fault *fault)
{
    const bool right = neighbours == 0 || (neighbours >= ISO_CLOUD_NEIGHBOURS_MIN &&
                                           neighbours <= ISO_CLOUD_NEIGHBOURS_MAX);
    return right ? 0
                 : iso_fault_set(fault, -EINVAL, "--neighbours: %d is not in %d..%d", neighbours,
                                 (int)ISO_CLOUD_NEIGHBOURS_MIN, (int)ISO_CLOUD_NEIGHBOURS_MAX);
}

int sim_source_look(const char *path, const struct sim_source_options *options,
                    struct sim_source_look *look, struct iso_fault *fault)
{
    struct iso_coloured_mesh mesh = {NULL, NULL};
    struct sim_source_look seen;
    int error = read_any(path, options->mend, &seen, &mesh, fault);
    if (!error && seen.points > 0) {
        error = look_at_cloud(path, options, mesh.mesh, &seen, fault);
    }
    iso_coloured_mesh_done(&mesh);
    if (!error) {
        *look = seen;
    }
    return error;
}

static void append(char *text, size_t size, int n, const char *one, const char *many,
                   const char *what)
{
    if (n > 0) {
        const size_t used = strlen(text);
        (void)snprintf(text + used, size - used, "%s%d %s %s", used ? "; " : "", n,
                       iso_plural((uint64_t)n, one, many), what);
    }
}

void sim_source_left_out(const struct sim_source_look *look, char *text, size_t size)
{
    const struct iso_part_survey *part = &look->part;
    text[0] = '\0';
    if (look->points > 0) {
        append(text, size, look->points_left_out, "point", "points", "left out");
        append(text, size, look->mended.merged, "point", "points", "merged");
        return;
    }
    append(text, size, part->n_parts - 1, "part", "parts", "left out");
    if (part->n_parts > 1) {
        const size_t used = strlen(text);
        (void)snprintf(text + used, size - used, ": %.2g %% of the area, %d vertices",
                       100.0 * loss_of(part), part->vertices_left_out);
    }
    append(text, size, look->mended.merged, "vertex", "vertices", "merged");
    append(text, size, look->mended.repeated, "triangle", "triangles", "repeated");
    append(text, size, look->mended.collapsed + part->flat_triangles, "triangle", "triangles",
           "without area");
    append(text, size, look->mended.unused, "vertex", "vertices", "unused");
}

/* The number of vertices to which a mesh was thinned may be a twentieth more than wanted. */
static int thin(const char *path, struct iso_coloured_mesh *mesh, int32_t wanted,
                struct iso_fault *fault)
{
    const int32_t before = mesh->mesh->n_vertices;
    const int error = sim_thin(mesh, wanted);
    if (error == -EINVAL) {
        return iso_fault_set(fault, -ENOTSUP,
                             "%s: --vertices %d: a vertex of it has more than %d triangles", path,
                             wanted, (int)SIM_DECIMATE_FAN_LIMIT);
    }
    if (error) {
        return iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
    }
    if (mesh->mesh->n_vertices > wanted + wanted / 20) {
        return iso_fault_set(fault, -ENOTSUP,
                             "%s: --vertices %d: %d of its %d vertices are left, because no more "
                             "edges can be collapsed without folding or cutting the surface",
                             path, wanted, mesh->mesh->n_vertices, before);
    }
    return 0;
}

static int change(const char *path, const char *name, const struct sim_source_options *options,
                  struct iso_coloured_mesh *mesh, struct iso_fault *fault)
{
    int error = 0;
    if (options->vertices > 0 && mesh->mesh->n_vertices > options->vertices) {
        error = thin(path, mesh, options->vertices, fault);
    }
    if (error) {
        return error;
    }
    if (options->distortion) {
        struct sim_random random = sim_random_seeded(options->seed, sim_random_hash(name),
                                                     (uint64_t)options->distortion->kind);
        error = sim_distort(*options->distortion, &random, mesh);
    }
    if (!error && options->smooth > 0) {
        error = sim_smooth(mesh->mesh, options->smooth);
    }
    return error ? iso_fault_set(fault, error, "%s: %s", path, strerror(-error)) : 0;
}

static int change_cloud(const char *path, const struct sim_source_options *options,
                        const struct sim_source_look *look, struct iso_fault *fault)
{
    const char *what = options->vertices > 0 && look->points > options->vertices ? "thinned"
                       : options->smooth > 0                                     ? "smoothed"
                       : options->distortion                                     ? "distorted"
                                                                                 : NULL;
    return what ? iso_fault_set(fault, -ENOTSUP, "%s: a cloud of points, which cannot be %s", path,
                                what)
                : 0;
}

int sim_source_read(const char *path, const char *name, const struct sim_source_options *options,
                    struct sim_source_look *look, struct iso_coloured_mesh *out,
                    struct iso_fault *fault)
{
    struct iso_coloured_mesh mesh = {NULL, NULL};
    struct sim_source_look seen;
    int error = read_any(path, options->mend, &seen, &mesh, fault);
    if (error) {
        return error;
    }
    error = seen.points > 0 ? change_cloud(path, options, &seen, fault)
                            : change(path, name, options, &mesh, fault);
    if (error) {
        iso_coloured_mesh_done(&mesh);
        return error;
    }
    if (look) {
        *look = seen;
    }
    *out = mesh;
    return 0;
}

static int refuse_shape(const char *path, int error, struct iso_fault *fault)
{
    switch (error) {
    case 0:
        return 0;
    case -ENODATA:
        return iso_fault_set(fault, error, "%s: its largest part has fewer than %d vertices", path,
                             (int)ISO_SHAPE_VERTICES_MIN);
    case -EDOM:
        return iso_fault_set(fault, error,
                             "%s: its matrices cannot be factorised: triangles are too thin, or "
                             "their sizes differ too much",
                             path);
    case -ENOTRECOVERABLE:
        return iso_fault_set(fault, error,
                             "%s: its eigenpairs do not converge, one of them is of a "
                             "multiplicity above 32, or it takes too many flips of edges to make "
                             "its triangulation intrinsic Delaunay",
                             path);
    case -EINVAL:
        return iso_fault_set(fault, error, "%s: a colour is outside 0..1, or not finite", path);
    default:
        return iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
    }
}

static int shape_of_cloud(const char *path, const struct iso_coloured_mesh *cloud,
                          const struct iso_colour *colour, const struct sim_shape_options *options,
                          struct iso_shape **out, struct iso_fault *fault)
{
    const struct iso_mesh *points = cloud->mesh;
    struct iso_shape *shape = NULL;
    if (iso_mesh_check(points, NULL)) {
        return iso_fault_set(fault, -EBADMSG, "%s: a coordinate is not finite", path);
    }
    int error = iso_shape_new_cloud(points->vertices_mm, colour, points->n_vertices,
                                    options->neighbours, options->n_pairs, &shape);
    error = refuse_shape(path, error, fault);
    if (error) {
        return error;
    }
    const int32_t left = points->n_vertices - shape->mesh->n_vertices;
    if (!options->mend && left > least_loss * points->n_vertices) {
        iso_shape_free(shape);
        return refuse_cloud(path, left, points->n_vertices, fault);
    }
    *out = shape;
    return 0;
}

int sim_source_shape(const char *path, const struct iso_coloured_mesh *mesh,
                     const struct sim_shape_options *options, struct iso_shape **out,
                     struct iso_fault *fault)
{
    if (options->colours && !mesh->colour) {
        return iso_fault_set(fault, -ENODATA, "%s: a method needs colours, and the file has none",
                             path);
    }
    const struct iso_colour *colour = options->colours ? mesh->colour : NULL;
    if (mesh->mesh->n_triangles == 0) {
        return shape_of_cloud(path, mesh, colour, options, out, fault);
    }
    const bool robust = options->laplacian == SIM_LAPLACIAN_ROBUST;
    return refuse_shape(
        path,
        (robust ? iso_shape_new_robust : iso_shape_new)(mesh->mesh, colour, options->n_pairs, out),
        fault);
}
