/* Readers for the scanner files of public databases. Each file becomes a triangle mesh in the
 * scanner's own frame: x to the right, y up, z towards the viewer, millimetres.
 *
 * Parsers work on bytes in memory that end with a NUL, which is not counted; `name` stands for
 * the file in faults. All refuse input that they do not understand: -EBADMSG with a fault that
 * states the reason; -ENOMEM. Free meshes with iso_mesh_free. */
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

/* A grid of points. The x of a point that was not measured is NAN. Free with sim_scan_grid_done. */
struct sim_scan_grid {
    int rows, columns;
    struct iso_vec3 *point_mm; /* [rows * columns] */
};

/* Makes a grid whose points are all zero. -EBADMSG for a size that is not a whole number or is out
 * of range, -ENOMEM. */
int sim_scan_grid_new(const char *name, double rows, double columns, struct sim_scan_grid *out,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* Frees the points and sets the grid to all zero. */
void sim_scan_grid_done(struct sim_scan_grid *grid);

/* Joins neighbours whose points are at most 12 mm apart. -EBADMSG if no triangle results. */
int sim_scan_grid_mesh(const char *name, const struct sim_scan_grid *grid, struct iso_mesh **out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* FRGC v2 (Phillips and others 2005): .abs, text: rows, columns, then the flags of all pixels,
 * then all x, all y and all z. x and y span the image, z is negative away from the scanner. */
int sim_scan_parse_abs(const char *name, const char *bytes, size_t size, struct iso_mesh **out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Bosphorus (Savran and others 2008): .bnt, little endian: rows u16, columns u16, the z value of
 * unmeasured pixels f64, a file name (u16 length and bytes), the number of values u32, then five
 * arrays of f64 over all pixels: x, y, z and two texture coordinates. */
int sim_scan_parse_bnt(const char *name, const char *bytes, size_t size, struct iso_mesh **out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* BU-3DFE (Yin and others 2006), GavabDB (Moreno and Sanchez 2004), CASIA-3D (Zhong, Sun and Tan
 * 2007): VRML 1.0 and 97. Only the indexed face sets are read: points of Coordinate (or
 * Coordinate3) and faces of coordIndex, which must follow their points. Polygons are cut into
 * fans. All other nodes, including transforms, are skipped. */
int sim_scan_parse_vrml(const char *name, const char *bytes, size_t size, struct iso_mesh **out,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
