/* Writes mesh files for the reader of isotherm/mesh_file.h. */
#ifndef SIM_SHAPES_MESH_MESH_WRITER_H
#define SIM_SHAPES_MESH_MESH_WRITER_H

#include "sim/shapes/mesh/mesh_file.h"

/* Writes a file and replaces an old one. The ending of the name selects the format: .off (COFF
 * with colours) and .vert (TOSCA, with its .tri; no colours) as text of nine digits, .ply as
 * little-endian binary of floats and bytes. The same mesh gives the same bytes. -ENOTSUP for
 * another ending, -ENAMETOOLONG, -EIO or the errno of opening it, each with a fault that names
 * the file. */
int sim_mesh_write(const char *path, const struct iso_coloured_mesh *mesh, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
