/* Facial expressions as weights of the head model's expression shapes. */
#ifndef SIM_WORLD_FACE_EXPRESSION_H
#define SIM_WORLD_FACE_EXPRESSION_H

#include "sim/base/random.h"
#include "sim/world/face/ict.h"

enum sim_expression {
    SIM_NEUTRAL = 0, /* what a face at rest still does: jitter of 0.03 a shape */
    SIM_MILD,        /* a little of smile, brow, eyelid and jaw: weights up to 0.3 */
    SIM_STRONG,      /* one of the strong ones below, drawn at random */
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

/* Draws weights, one per shape (ict->n_expression, at most SIM_EXPRESSION_SHAPES_MAX), each 0..1.
 * Left and right halves of a shape go together but for about 10%. Returns the expression drawn: for
 * SIM_STRONG the one it became, else the argument itself. */
enum sim_expression sim_expression_draw(const struct sim_ict *ict, enum sim_expression expression,
                                        struct sim_random *random, double *weights);

#endif
