/* Reads the vertices and faces of a Wavefront OBJ file in the order of the file. Nothing is
 * merged, mended or left out. */
#ifndef SIM_WORLD_FACE_OBJ_POINTS_H
#define SIM_WORLD_FACE_OBJ_POINTS_H

#include <stdint.h>

#include "core/base/fault.h"

struct sim_obj {
    uint32_t n_points, n_triangles;
    double (*points)[3]; /* as written */
    /* A polygon is split into triangles that share its first corner. Vertex numbers begin at 0. */
    uint32_t (*triangles)[3];
};

/* Reads a file. -EBADMSG: a vertex (line "v") does not have three numbers, a face (line "f") does
 * not have 3 to 16 corners, or a corner is not a vertex of an earlier line. -ENOMEM, or an error of
 * opening or reading. Lines of other kinds are skipped. */
int sim_obj_read(const char *path, struct sim_obj *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Releases what it holds. */
void sim_obj_done(struct sim_obj *obj);

#endif
