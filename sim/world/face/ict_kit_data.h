/* Data about a clone of ICT-FaceKit while it is imported. Internal to sim/world/face. */
#ifndef SIM_WORLD_FACE_ICT_KIT_DATA_H
#define SIM_WORLD_FACE_ICT_KIT_DATA_H

#include <limits.h>
#include <stdbool.h>

#include "sim/world/face/ict_kit.h"
#include "sim/world/face/obj_points.h"

enum { SIM_KIT_NAME_SIZE = 32 };

#define SIM_KIT_NEUTRAL "generic_neutral_mesh"

struct sim_kit {
    const struct sim_ict_layout *layout;
    char folder[PATH_MAX]; /* FaceXModel */
    const char *to;
    char (*expressions)[SIM_KIT_NAME_SIZE]; /* sorted */
    uint32_t n_expressions;
    uint32_t *landmarks; /* [layout->n_landmarks], indices among the kept vertices */
    struct sim_obj neutral;
    struct iso_fault *fault;
};

/* The index among the kept vertices; false for a vertex that is left out. */
bool sim_kit_renumber(const struct sim_ict_layout *layout, uint32_t vertex, uint32_t *out);

/* The path of a shape's file. -ENAMETOOLONG with a fault. */
int sim_kit_obj_path(const struct sim_kit *kit, const char *name, char path[PATH_MAX]);

/* The name of identity number i. */
void sim_kit_identity_name(uint32_t i, char name[SIM_KIT_NAME_SIZE]);

/* Reads the shapes and writes the files of the head model. The kit's names and landmarks must be
 * set. Returns an error of reading or writing, with a fault. */
int sim_kit_convert(struct sim_kit *kit, struct sim_ict_kit_report *report)
    __attribute__((warn_unused_result));

#endif
