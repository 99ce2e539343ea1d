/* Reads triangle meshes from files of other programs.
 *
 *   .off    OFF and COFF, text (Geomview)
 *   .obj    Wavefront, text: v (with colours, as MeshLab writes them) and f; statements for
 *           normals, texture, groups and materials are ignored
 *   .ply    text, little and big endian; elements `vertex` and `face`; others are ignored
 *   .stl    text and binary; each triangle comes with vertices of its own
 *   .vert   TOSCA: one vertex in each line; the .tri beside it has one triangle in each line,
 *           counted from 1
 *
 * Faces of more than three corners are cut into fans. Coordinates are not converted, whatever
 * their unit. A reader refuses contents that it does not understand, with a fault "file:line: what
 * is wrong", or "file: what is wrong" for a fault of the whole file. Mending deals with defects of
 * a mesh that could be read. */
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

/* Releases what it holds. */
void iso_coloured_mesh_done(struct iso_coloured_mesh *mesh);

enum iso_mesh_format {
    ISO_MESH_FORMAT_OFF,
    ISO_MESH_FORMAT_OBJ,
    ISO_MESH_FORMAT_PLY,
    ISO_MESH_FORMAT_STL,
    ISO_MESH_FORMAT_TOSCA,
    ISO_MESH_FORMATS
};

/* "off", "obj", "ply", "stl", "vert": the ending of the file name; NULL for an unknown format. */
const char *iso_mesh_format_suffix(enum iso_mesh_format format);

/* The defects that mending removed. */
struct iso_mesh_mended {
    int32_t merged;    /* vertices at exactly the same place as another one */
    int32_t collapsed; /* triangles with two corners at the same place */
    int32_t repeated;  /* triangles with the same three corners as another one, in any order */
    int32_t unused;    /* vertices of no triangle */
};

/* Reads a file by the ending of its name and mends it (see iso_mesh_mend). -ENOENT; -EBADMSG for
 * refused contents or a mesh without a triangle; -ENOTSUP for another ending; -EFBIG above 1 GiB
 * or for too many vertices or triangles; -ENOMEM; or the errno of open and read. Each comes with a
 * fault that names the file. */
int iso_mesh_file_read(const char *path, struct iso_coloured_mesh *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The same, with a report of what was mended, which may be NULL. */
int iso_mesh_file_read_report(const char *path, struct iso_coloured_mesh *out,
                              struct iso_mesh_mended *report, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The same from memory and without mending: triangles may repeat a corner or each other, but
 * their indices are in range. `bytes` is changed; a NUL must follow its end. A TOSCA mesh
 * consists of two texts; `tri` is NULL for other formats. `name` stands for the file in faults.
 * -EBADMSG, -EFBIG, -ENOMEM; each with a fault. */
int iso_mesh_parse(enum iso_mesh_format format, const char *name, char *bytes, size_t size,
                   char *tri, struct iso_coloured_mesh *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Mends a mesh by these rules:
 *
 *  - Vertices at exactly the same place become one vertex with the mean of their colours, so that
 *    separately written faces are connected.
 *  - Triangles with two corners at the same place, and copies of a triangle, are removed.
 *  - Vertices of no triangle are removed.
 *  - Boundaries, edges of more than two triangles, triangles without area, triangles that are
 *    turned inside out, and several components stay, because heat needs no more.
 *    isotherm/shape.h describes how they are handled.
 *
 * The remaining vertices and triangles keep their order. `report` may be NULL. -EBADMSG if no
 * triangle remains, -ENOMEM; the mesh is then unchanged. */
int iso_mesh_mend(struct iso_coloured_mesh *mesh, struct iso_mesh_mended *report)
    __attribute__((warn_unused_result));

#endif
