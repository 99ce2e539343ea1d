/* Reads the mesh files of isotherm/mesh_file.h by their names. */
#ifndef ISO_SIM_SHAPES_MESH_MESH_FILE_H
#define ISO_SIM_SHAPES_MESH_MESH_FILE_H

#include "core/base/fault.h"
#include "isotherm/mesh_file.h"

/* Reads a file by the ending of its name (.off, .obj, .ply, .stl; .vert, with the .tri beside it)
 * and mends it (see iso_mesh_mend). -ENOENT; -EBADMSG for refused contents or a mesh without a
 * triangle; -ENOTSUP for another ending; -EFBIG above 1 GiB or for too many vertices or triangles;
 * -ENOMEM; or the errno of open and read. Each comes with a fault that names the file. */
int iso_mesh_file_read(const char *path, struct iso_coloured_mesh *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The same, with a report of what was mended, which may be NULL. */
int iso_mesh_file_read_report(const char *path, struct iso_coloured_mesh *out,
                              struct iso_mesh_mended *report, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads a mesh as above, or a cloud: a file without triangles (.off, .obj, .ply), or one named
 * .xyz. A cloud is a mesh without triangles. -EBADMSG also for a file without a point. */
int iso_mesh_or_cloud_file_read(const char *path, struct iso_coloured_mesh *out,
                                struct iso_mesh_mended *report, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
