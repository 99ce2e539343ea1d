/* Triangle meshes in files, as they come from elsewhere.
 *
 *   .off    OFF and COFF, text (Geomview)
 *   .obj    Wavefront, text: v (with colours, as MeshLab writes them) and f; what has to do with
 *           normals, texture, groups and materials is passed over
 *   .ply    text, little and big endian; elements `vertex` and `face`, others are passed over
 *   .stl    text and binary; each triangle comes with vertices of its own
 *   .vert   TOSCA: a vertex a line; the .tri beside it has a triangle a line, counted from 1
 *
 * Faces of more than three corners are cut into fans. Coordinates are not converted, whatever
 * their unit. A reader refuses what it does not understand: every failure is one line "file:line:
 * what is wrong". Mending deals with defects of a mesh that could be read. */
#ifndef ISO_SIM_SHAPES_MESH_MESH_FILE_H
#define ISO_SIM_SHAPES_MESH_MESH_FILE_H

#include <stddef.h>

#include "core/base/fault.h"
#include "isotherm/shape.h"

/* A mesh and the colours of its vertices, if it has any. All-zero is empty. */
struct iso_coloured_mesh {
    struct iso_mesh *mesh;
    struct iso_colour *colour; /* [mesh->n_vertices], each channel 0..1; or NULL */
};

void iso_coloured_mesh_done(struct iso_coloured_mesh *mesh);

enum iso_mesh_format {
    ISO_MESH_FORMAT_OFF,
    ISO_MESH_FORMAT_OBJ,
    ISO_MESH_FORMAT_PLY,
    ISO_MESH_FORMAT_STL,
    ISO_MESH_FORMAT_TOSCA,
    ISO_MESH_FORMATS
};

/* "off", "obj", "ply", "stl", "vert": the end of such a file's name; NULL for no format. */
const char *iso_mesh_format_suffix(enum iso_mesh_format format);

/* Reads a file by the end of its name and mends it (see iso_mesh_mend). -ENOENT, -EBADMSG for
 * contents that are refused or a mesh without a single triangle, -ENOTSUP for another name, -EFBIG
 * above 1 GiB, -ENOMEM, or the errno of open and read; each with a fault that names the file. */
int iso_mesh_file_read(const char *path, struct iso_coloured_mesh *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The same from memory, not mended: triangles may repeat a corner or each other, but their indices
 * are in range. `bytes` is changed; a NUL has to stand behind its end. A TOSCA mesh is two
 * texts; `tri` is NULL for other formats. `name` stands for the file in faults. */
int iso_mesh_parse(enum iso_mesh_format format, const char *name, char *bytes, size_t size,
                   char *tri, struct iso_coloured_mesh *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* What mending did, and what a mesh is like after it. */
struct iso_mesh_mended {
    int32_t merged;    /* vertices that lay exactly where another did */
    int32_t collapsed; /* triangles with two corners in one place */
    int32_t repeated;  /* triangles of the same three corners as another, whichever way round */
    int32_t unused;    /* vertices of no triangle */
};

/* The rule for meshes as they come:
 *
 *  - vertices in exactly the same place become one (its colour the mean of theirs), so that faces
 *    that were written apart hang together;
 *  - triangles with two corners in one place, and copies of a triangle, are left out;
 *  - vertices of no triangle are left out;
 *  - boundaries, edges of more than two triangles, triangles without area, triangles that are
 *    turned inside out and several components stay: heat needs nothing else.
 * isotherm/shape.h says what is done about them.
 *
 * What is left keeps its order. `report` may be NULL. -EBADMSG if no triangle is left, -ENOMEM; the
 * mesh is then as it was. */
int iso_mesh_mend(struct iso_coloured_mesh *mesh, struct iso_mesh_mended *report)
    __attribute__((warn_unused_result));

#endif
