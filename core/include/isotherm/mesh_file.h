/** @file
 * Triangle meshes and clouds of points of other programs: the contents of their files, and what is
 * mended in them.
 *
 *  - OFF and COFF, text (Geomview);
 *  - OBJ (Wavefront), text: v (with colours, as MeshLab writes them) and f; statements for normals,
 *    texture, groups and materials are ignored;
 *  - PLY, as text, little and big endian; elements `vertex` and `face`; others are ignored;
 *  - STL, as text and binary; each triangle comes with vertices of its own;
 *  - TOSCA: one vertex in each line of the .vert; one triangle in each line of the .tri, counted
 *    from 1;
 *  - XYZ, text: a point in each line; what follows its three numbers is ignored.
 *
 * OFF, OBJ, PLY and XYZ may have points without triangles: a cloud.
 *
 * Faces of more than three corners are cut into fans. Coordinates are not converted, whatever their
 * unit. A reader refuses contents that it does not understand, with a fault "file:line: what is
 * wrong", or "file: what is wrong" for a fault of the whole file. Mending deals with defects of a
 * mesh that could be read.
 *
 * Numbers have a decimal point. A program that has called setlocale() with another LC_NUMERIC than
 * "C" gets faults about numbers with a point. */
#ifndef ISOTHERM_MESH_FILE_H
#define ISOTHERM_MESH_FILE_H

#include <stddef.h>

#include "isotherm/fault.h"
#include "isotherm/mesh.h"
#include "isotherm/shape.h"

/** A mesh and the colours of its vertices, if it has any. It owns both. All-zero is empty. */
struct iso_coloured_mesh {
    struct iso_mesh *mesh;     /**< The mesh. */
    struct iso_colour *colour; /**< [mesh->n_vertices], each channel 0..1; or NULL. */
};

/** Frees what the struct holds, and empties it.
 *
 * @param mesh  The mesh. */
void iso_coloured_mesh_done(struct iso_coloured_mesh *mesh);

/** A format of mesh files. */
enum iso_mesh_format {
    ISO_MESH_FORMAT_OFF,   /**< OFF, COFF. */
    ISO_MESH_FORMAT_OBJ,   /**< Wavefront. */
    ISO_MESH_FORMAT_PLY,   /**< PLY (Turk 1994). */
    ISO_MESH_FORMAT_STL,   /**< STL. */
    ISO_MESH_FORMAT_TOSCA, /**< Two files, .vert and .tri. */
    ISO_MESH_FORMAT_XYZ,   /**< Points alone. */
    ISO_MESH_FORMATS       /**< How many formats there are. */
};

/** The ending of the names of a format's files.
 *
 * @param format  The format.
 * @return "off", "obj", "ply", "stl", "vert", "xyz"; NULL for an unknown format. */
const char *iso_mesh_format_suffix(enum iso_mesh_format format);

/** Reads a mesh from the contents of its file, without mending it: triangles may repeat a corner or
 * each other, but their indices are in range.
 *
 * @param format  The format.
 * @param name    Stands for the file in faults.
 * @param bytes   [size]: the contents, which are changed; a zero byte must follow their end.
 * @param size    How many bytes.
 * @param tri     Of TOSCA, the contents of the .tri, ended by a zero byte, which are changed; NULL
 *                for other formats.
 * @param out     Receives the mesh; free it with iso_coloured_mesh_done().
 * @param fault   If not NULL: on failure, receives a text that says what is wrong.
 * @return 0; -EBADMSG for refused contents or a mesh without a triangle; -EFBIG for too many
 *         vertices or triangles; -ENOMEM. */
int iso_mesh_parse(enum iso_mesh_format format, const char *name, char *bytes, size_t size,
                   char *tri, struct iso_coloured_mesh *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/** Reads a mesh or a cloud of points: as iso_mesh_parse(), but contents without triangles are no
 * fault. They give a mesh without triangles, of which iso_shape_new_cloud() makes a shape.
 *
 * @param format  The format.
 * @param name    Stands for the file in faults.
 * @param bytes   [size]: as for iso_mesh_parse().
 * @param size    How many bytes.
 * @param tri     As for iso_mesh_parse().
 * @param out     Receives the mesh; free it with iso_coloured_mesh_done().
 * @param fault   If not NULL: on failure, receives a text that says what is wrong.
 * @return As iso_mesh_parse(); -EBADMSG if there are no vertices. */
int iso_mesh_or_cloud_parse(enum iso_mesh_format format, const char *name, char *bytes, size_t size,
                            char *tri, struct iso_coloured_mesh *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/** The defects that mending removed. */
struct iso_mesh_mended {
    int32_t merged;    /**< Vertices at exactly the same place as another one. */
    int32_t collapsed; /**< Triangles with two corners at the same place. */
    int32_t repeated;  /**< Triangles with the same corners as another one, in any order. */
    int32_t unused;    /**< Vertices of no triangle. */
};

/** Mends a mesh by these rules:
 *
 *  - Vertices at exactly the same place become one vertex with the mean of their colours, so that
 *    separately written faces are connected.
 *  - Triangles with two corners at the same place, and copies of a triangle, are removed.
 *  - Vertices of no triangle are removed, except from a cloud, which has no triangles.
 *  - Boundaries, edges of more than two triangles, triangles without area, triangles that are
 *    turned inside out, and several components stay, because heat needs no more. shape.h describes
 *    how they are handled.
 *
 * The remaining vertices and triangles keep their order.
 *
 * @param mesh    The mesh, or a cloud; every index of its triangles is in range.
 * @param report  If not NULL: receives what was removed.
 * @return 0; -EBADMSG if no triangle of a mesh remains, or without vertices; -ENOMEM; the mesh is
 *         then unchanged. */
int iso_mesh_mend(struct iso_coloured_mesh *mesh, struct iso_mesh_mended *report)
    __attribute__((warn_unused_result));

#endif
