/* The ICT-FaceKit statistical head model, read from the folder `ict-face`. The simulator renders
 * it and the trainer learns from it. Its frame: x to the subject's left, y up, z out of the
 * face, millimetres. */
#ifndef SIM_WORLD_FACE_ICT_H
#define SIM_WORLD_FACE_ICT_H

#include <stdint.h>

#include "core/base/fault.h"

/* Vertices are ordered by part. A part reaches from its first vertex to the next part's first. */
enum sim_ict_part {
    SIM_ICT_FACE = 0,
    SIM_ICT_NARROW_FACE_END = 6706, /* the face without ears and throat */
    SIM_ICT_HEAD = 9409,            /* head and neck */
    SIM_ICT_MOUTH_SOCKET = 11248,
    SIM_ICT_EYE_SOCKETS = 13294,
    SIM_ICT_EYEBALLS = 14062,
    SIM_ICT_VERTICES = 17202,
};

struct sim_ict {
    uint32_t n_vertices, n_triangles, n_identity, n_expression;
    float *mean_mm;           /* [n_vertices][3] */
    uint32_t (*triangles)[3]; /* counter-clockwise seen from outside */
    float *identity_mm;       /* [n_identity][n_vertices][3], mm per standard deviation */
    float *expression_mm;     /* [n_expression][n_vertices][3], mm at weight 1 */
    char (*expression_names)[32];
    uint32_t landmarks[68]; /* vertex of each iBUG landmark */
};

/* Reads mean.npy, triangles.npy, identity.npy, expression.npy, expression_names.txt and
 * landmarks68.txt. Returns an error of opening; -EBADMSG with *fault for a damaged file or for
 * one that does not match the others; or -ENOMEM. */
int sim_ict_load(const char *directory, struct sim_ict **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_ict_free(struct sim_ict *ict);

/* Index of an expression shape by its name, or -1. */
int sim_ict_expression(const struct sim_ict *ict, const char *name);

#endif
