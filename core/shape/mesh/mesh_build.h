/* Builds a mesh from vertices and faces one by one while a file is read. Internal to
 * core/shape/mesh. */
#ifndef ISO_CORE_SHAPE_MESH_MESH_BUILD_H
#define ISO_CORE_SHAPE_MESH_MESH_BUILD_H

#include <stdbool.h>

#include "core/base/fault.h"
#include "isotherm/mesh_file.h"

enum {
    ISO__MESH_MOST = 50000000,       /* vertices or triangles */
    ISO__MESH_CORNERS_MOST = 100000, /* of a face */
};

struct iso__mesh_build {
    const char *name; /* of the file, for faults */
    struct iso_fault *fault;
    struct iso_coloured_mesh made;
    int32_t colour_capacity; /* 0: no colours so far */
    bool points;             /* a file without triangles is a cloud of points, no fault */
};

/* `name` and `fault` are borrowed. -ENOMEM. */
int iso__mesh_build_init(struct iso__mesh_build *build, const char *name, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Adds a vertex, with a colour or NULL: either all vertices have a colour or none. -EBADMSG,
 * -EFBIG, -ENOMEM, with a fault for line `line`. */
int iso__mesh_build_vertex(struct iso__mesh_build *build, unsigned line, struct iso_vec3 at_mm,
                           const struct iso_colour *colour) __attribute__((warn_unused_result));

/* Adds a triangle; indices count from 0 and are checked at the end. -EFBIG, -ENOMEM, with a fault.
 */
int iso__mesh_build_triangle(struct iso__mesh_build *build, unsigned line, const int32_t corner[3])
    __attribute__((warn_unused_result));

/* Checks that there are triangles, or with `points` at least vertices, and that every index has a
 * vertex. Hands the mesh to the caller.
 * -EBADMSG with a fault. */
int iso__mesh_build_finish(struct iso__mesh_build *build, struct iso_coloured_mesh *out)
    __attribute__((warn_unused_result));

/* Frees the mesh unless it was handed over. */
void iso__mesh_build_done(struct iso__mesh_build *build);

/* Sets the fault "NAME:LINE: WHAT 'WORD'" and returns -EBADMSG. */
int iso__mesh_build_refuse(const struct iso__mesh_build *build, unsigned line, const char *what,
                           const char *word) __attribute__((warn_unused_result));

/* Reads three words as coordinates. -EBADMSG. */
int iso__mesh_build_place(const struct iso__mesh_build *build, unsigned line, char *const words[3],
                          struct iso_vec3 *out) __attribute__((warn_unused_result));

/* Reads three words as a colour: whole numbers of 0..255 or, if one of them has a point, numbers
 * of 0..1. -EBADMSG. */
int iso__mesh_build_colour(const struct iso__mesh_build *build, unsigned line, char *const words[3],
                           struct iso_colour *out) __attribute__((warn_unused_result));

/* The readers. Each fills a build from a text (or bytes), which it may change. */
int iso__mesh_read_off(struct iso__mesh_build *build, char *text)
    __attribute__((warn_unused_result));
int iso__mesh_read_obj(struct iso__mesh_build *build, char *text)
    __attribute__((warn_unused_result));
int iso__mesh_read_ply(struct iso__mesh_build *build, char *bytes, size_t size)
    __attribute__((warn_unused_result));
int iso__mesh_read_stl(struct iso__mesh_build *build, char *bytes, size_t size)
    __attribute__((warn_unused_result));
int iso__mesh_read_xyz(struct iso__mesh_build *build, char *text)
    __attribute__((warn_unused_result));
int iso__mesh_read_tosca(struct iso__mesh_build *build, char *vert, char *tri)
    __attribute__((warn_unused_result));

#endif
