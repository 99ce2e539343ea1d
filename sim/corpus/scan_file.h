/* Files of face scanners, as public databases have them: each becomes a triangle mesh in the
 * scanner's own frame, x to the right, y up, z towards the viewer, millimetres.
 *
 * Parsers work on bytes in memory that end with a NUL which is not counted; `name` stands for the
 * file in faults. All refuse what they do not understand: -EBADMSG with a fault that says what is
 * wrong; -ENOMEM. Meshes are freed with iso_mesh_free. */
#ifndef SIM_CORPUS_SCAN_FILE_H
#define SIM_CORPUS_SCAN_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "isotherm/mesh.h"

enum {
    SIM_SCAN_SIDE_MAX = 4096,                /* rows and columns of a grid */
    SIM_SCAN_POINTS_MAX = 4 * 1024 * 1024,   /* of a grid or a mesh */
    SIM_SCAN_BYTES_MAX = 1024 * 1024 * 1024, /* of a file */
};

/* A grid of points, some of them not measured (x is NAN). Owned by whoever made it. */
struct sim_scan_grid {
    int rows, columns;
    struct iso_vec3 *point_mm; /* [rows * columns] */
};

/* -EBADMSG for a size out of range, -ENOMEM. */
int sim_scan_grid_new(const char *name, double rows, double columns, struct sim_scan_grid *out,
                      struct iso_fault *fault) __attribute__((warn_unused_result));
void sim_scan_grid_done(struct sim_scan_grid *grid);

/* Joins neighbours whose points are at most 12 mm apart. -EBADMSG if no triangle results. */
int sim_scan_grid_mesh(const char *name, const struct sim_scan_grid *grid, struct iso_mesh **out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* FRGC v2 (Phillips and others 2005): .abs, text: rows, columns, then a flag, x, y and z of every
 * pixel, all of one kind after the other; x and y across, z negative away from the scanner. */
int sim_scan_parse_abs(const char *name, const char *bytes, size_t size, struct iso_mesh **out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Bosphorus (Savran and others 2008): .bnt, little endian: rows u16, columns u16, the z of what was
 * not measured f64, a file name (u16 length and bytes), the number of values u32, then x, y, z and
 * two texture coordinates of every pixel, f64, all of one kind after the other. */
int sim_scan_parse_bnt(const char *name, const char *bytes, size_t size, struct iso_mesh **out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* BU-3DFE (Yin and others 2006), GavabDB (Moreno and Sanchez 2004), CASIA-3D (Zhong, Sun and Tan
 * 2007): VRML 1.0 and 97. Of a file, the indexed face sets: points of Coordinate (or Coordinate3)
 * and faces of coordIndex, which must follow their points; polygons are cut into fans. Everything
 * else, transforms too, is passed over. */
int sim_scan_parse_vrml(const char *name, const char *bytes, size_t size, struct iso_mesh **out,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
