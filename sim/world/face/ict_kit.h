/* The layout of ICT-FaceKit in its public repository (https://github.com/ICT-VGL/ICT-FaceKit,
 * MIT): the folder FaceXModel holds OBJ files in centimetres. All have the same vertices in the
 * same order. One is the neutral head; each of the others is the neutral head moved by one
 * shape. The file vertex_indices.json names the expressions and the vertices of 68 landmarks. */
#ifndef SIM_WORLD_FACE_ICT_KIT_H
#define SIM_WORLD_FACE_ICT_KIT_H

#include <stdint.h>

#include "core/base/fault.h"

enum { SIM_ICT_KIT_RANGES = 2 };

/* What the repository's files hold, and which vertices the simulator's head model keeps. */
struct sim_ict_layout {
    uint32_t n_vertices; /* of every OBJ file */
    uint32_t n_identity; /* identity000.obj, ... */
    uint32_t n_landmarks;
    struct {
        uint32_t first, end; /* [first, end) */
    } kept[SIM_ICT_KIT_RANGES];
};

/* The layout of the public repository. Face, head and neck, mouth socket and eye sockets (0 to
 * 14061) and the eyeballs (21451 to 24590) are kept. Gums, tongue, teeth, lacrimal fluid, eye
 * blend, eye occlusion and eyelashes are left out. */
extern const struct sim_ict_layout sim_ict_kit_layout;

struct sim_ict_kit_report {
    uint32_t n_vertices, n_triangles, n_identity, n_expression;
};

/* Reads the repository (or its folder FaceXModel) `from`, and writes the files that sim_ict_load
 * reads into the directory `to`, which is created if it is missing. -ENOENT: files are missing;
 * the fault names the first and counts all. -EBADMSG: a file does not match the layout. -ENOMEM,
 * or an error of reading or writing. */
int sim_ict_import(const char *from, const struct sim_ict_layout *layout, const char *to,
                   struct sim_ict_kit_report *report, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
