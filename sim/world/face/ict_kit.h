/* ICT-FaceKit as its public repository has it (https://github.com/ICT-VGL/ICT-FaceKit, MIT): a
 * folder FaceXModel of OBJ files in centimetres, all with the same vertices in the same order, of
 * which each but the neutral one is moved by one shape; and vertex_indices.json, which names the
 * expressions and the vertices of 68 landmarks. */
#ifndef SIM_WORLD_FACE_ICT_KIT_H
#define SIM_WORLD_FACE_ICT_KIT_H

#include <stdint.h>

#include "core/base/fault.h"

enum { SIM_ICT_KIT_RANGES = 2 };

/* What the repository's files hold, and what of it the simulator's head model keeps. */
struct sim_ict_layout {
    uint32_t n_vertices; /* of every OBJ file */
    uint32_t n_identity; /* identity000.obj, ... */
    uint32_t n_landmarks;
    struct {
        uint32_t first, end; /* [first, end) */
    } kept[SIM_ICT_KIT_RANGES];
};

/* The repository's: face, head and neck, mouth socket and eye sockets (0 to 14061), and the
 * eyeballs (21451 to 24590) are kept; gums, tongue, teeth, lacrimal fluid, eye blend, eye occlusion
 * and eyelashes are not. */
extern const struct sim_ict_layout sim_ict_kit_layout;

struct sim_ict_kit_report {
    uint32_t n_vertices, n_triangles, n_identity, n_expression;
};

/* Reads the repository (or its folder FaceXModel) `from`, and writes the files that sim_ict_load
 * reads into the directory `to`, which is made if it is missing. -ENOENT with the name of the first
 * file that is missing and how many are; -EBADMSG a file that does not fit the layout; -ENOMEM;
 * errors of reading and writing. */
int sim_ict_import(const char *from, const struct sim_ict_layout *layout, const char *to,
                   struct sim_ict_kit_report *report, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
