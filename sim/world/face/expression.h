/* Facial expressions as weights of the head model's expression shapes. */
#ifndef SIM_WORLD_FACE_EXPRESSION_H
#define SIM_WORLD_FACE_EXPRESSION_H

#include "sim/base/random.h"
#include "sim/world/face/ict.h"

enum sim_expression {
    SIM_NEUTRAL = 0, /* a face at rest: each weight jitters by 0.03, eyelids close by up to 0.1 */
    SIM_MILD,        /* a little of smile, brow, eyelid and jaw: weights up to 0.3 */
    SIM_STRONG,      /* one of the strong expressions below, drawn at random */
    SIM_SMILE,
    SIM_MOUTH_WIDE,
    SIM_MOUTH_HALF,
    SIM_EYES_CLOSED,
    SIM_FROWN,
    SIM_PUCKER,
    SIM_CHEEK_PUFF,
    SIM_SQUINT,
    SIM_DISGUST,
    SIM_SURPRISE,
    SIM_EXPRESSIONS
};

/* "neutral", "mild", "strong", "smile", "mouth-wide", ...; NULL outside the range. */
const char *sim_expression_name(enum sim_expression expression);

/* Draws weights, one per shape (ict->n_expression, at most SIM_EXPRESSION_SHAPES_MAX), each
 * 0..1. The left and right halves of a shape have the same weight up to about 10%. Returns the
 * expression that was drawn: one of the strong expressions for SIM_STRONG, otherwise the
 * argument itself. */
enum sim_expression sim_expression_draw(const struct sim_ict *ict, enum sim_expression expression,
                                        struct sim_random *random, double *weights);

#endif
