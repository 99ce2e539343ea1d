#include "core/shape/mesh/mesh_build.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/text.h"

int iso__mesh_build_init(struct iso__mesh_build *build, const char *name, struct iso_fault *fault)
{
    *build = (struct iso__mesh_build){.name = name, .fault = fault};
    if (iso_mesh_new(256, 512, &build->made.mesh)) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", name);
    }
    return 0;
}

int iso__mesh_build_refuse(const struct iso__mesh_build *build, unsigned line, const char *what,
                           const char *word)
{
    return iso_fault_set(build->fault, -EBADMSG, "%s:%u: %s '%.40s'", build->name, line, what,
                         word);
}

static int out_of_memory(const struct iso__mesh_build *build)
{
    return iso_fault_set(build->fault, -ENOMEM, "%s: out of memory", build->name);
}

static int too_many(const struct iso__mesh_build *build, unsigned line, const char *what)
{
    return iso_fault_set(build->fault, -EFBIG, "%s:%u: more than %d %s", build->name, line,
                         (int)ISO__MESH_MOST, what);
}

int iso__mesh_build_vertex(struct iso__mesh_build *build, unsigned line, struct iso_vec3 at_mm,
                           const struct iso_colour *colour)
{
    struct iso_mesh *mesh = build->made.mesh;
    if (mesh->n_vertices == ISO__MESH_MOST) {
        return too_many(build, line, "vertices");
    }
    if (mesh->n_vertices > 0 && !colour != !build->made.colour) {
        return iso_fault_set(build->fault, -EBADMSG, "%s:%u: some vertices have a colour, not all",
                             build->name, line);
    }
    if (iso_mesh_reserve(mesh, mesh->n_vertices + 1, 0)) {
        return out_of_memory(build);
    }
    if (colour && build->colour_capacity < mesh->vertex_capacity) {
        void *moved = realloc(build->made.colour,
                              (size_t)mesh->vertex_capacity * sizeof *build->made.colour);
        if (!moved) {
            return out_of_memory(build);
        }
        build->made.colour = moved;
        build->colour_capacity = mesh->vertex_capacity;
    }
    if (colour) {
        build->made.colour[mesh->n_vertices] = *colour;
    }
    mesh->vertices_mm[mesh->n_vertices++] = at_mm;
    return 0;
}

int iso__mesh_build_triangle(struct iso__mesh_build *build, unsigned line, const int32_t corner[3])
{
    struct iso_mesh *mesh = build->made.mesh;
    if (mesh->n_triangles == ISO__MESH_MOST) {
        return too_many(build, line, "triangles");
    }
    if (iso_mesh_reserve(mesh, 0, mesh->n_triangles + 1)) {
        return out_of_memory(build);
    }
    memcpy(mesh->triangles[mesh->n_triangles++], corner, sizeof *mesh->triangles);
    return 0;
}

int iso__mesh_build_finish(struct iso__mesh_build *build, struct iso_coloured_mesh *out)
{
    const struct iso_mesh *mesh = build->made.mesh;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            const int32_t c = mesh->triangles[t][k];
            if (c < 0 || c >= mesh->n_vertices) {
                return iso_fault_set(build->fault, -EBADMSG,
                                     "%s: triangle %d has a corner that is none of the %d vertices",
                                     build->name, (int)t + 1, (int)mesh->n_vertices);
            }
        }
    }
    if (mesh->n_triangles == 0 && !(build->points && mesh->n_vertices > 0)) {
        return iso_fault_set(build->fault, -EBADMSG, "%s: no %s", build->name,
                             build->points ? "points"
                             : mesh->n_vertices > 0
                                 ? "triangles: a cloud of points, which is not wanted here"
                                 : "triangles");
    }
    *out = build->made;
    build->made = (struct iso_coloured_mesh){NULL, NULL};
    return 0;
}

void iso__mesh_build_done(struct iso__mesh_build *build)
{
    iso_coloured_mesh_done(&build->made);
}

int iso__mesh_build_place(const struct iso__mesh_build *build, unsigned line, char *const words[3],
                          struct iso_vec3 *out)
{
    double v[3];
    for (int k = 0; k < 3; k++) {
        if (iso_text_number(words[k], &v[k])) {
            return iso__mesh_build_refuse(build, line, "bad coordinate", words[k]);
        }
    }
    *out = iso_vec3(v[0], v[1], v[2]);
    return 0;
}

int iso__mesh_build_colour(const struct iso__mesh_build *build, unsigned line, char *const words[3],
                           struct iso_colour *out)
{
    const bool fraction = strchr(words[0], '.') || strchr(words[1], '.') || strchr(words[2], '.');
    double most = fraction ? 1.0 : 255.0, v;
    struct iso_colour colour;
    for (int k = 0; k < 3; k++) {
        if (iso_text_number(words[k], &v) || !(v >= 0.0 && v <= most)) {
            return iso__mesh_build_refuse(build, line, "bad colour", words[k]);
        }
        colour.channel[k] = (float)(v / most);
    }
    *out = colour;
    return 0;
}
