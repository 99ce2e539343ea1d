#include "sim/world/face/expression.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

static const double rest_jitter = 0.03, asymmetry = 0.1;

/* A shape (or both of its halves, `name`_L and `name`_R) and the range of its random weight. */
struct component {
    enum sim_expression expression;
    const char *name;
    double from, to;
};

static const struct component components[] = {
    {SIM_NEUTRAL, "eyeBlink", 0.0, 0.1},        {SIM_MILD, "mouthSmile", 0.0, 0.3},
    {SIM_MILD, "browInnerUp", 0.0, 0.3},        {SIM_MILD, "browDown", 0.0, 0.2},
    {SIM_MILD, "eyeBlink", 0.0, 0.3},           {SIM_MILD, "eyeSquint", 0.0, 0.2},
    {SIM_MILD, "jawOpen", 0.0, 0.12},           {SIM_MILD, "mouthPress", 0.0, 0.2},
    {SIM_MILD, "mouthFrown", 0.0, 0.2},         {SIM_SMILE, "mouthSmile", 0.7, 1.0},
    {SIM_SMILE, "cheekSquint", 0.3, 0.8},       {SIM_SMILE, "eyeSquint", 0.1, 0.5},
    {SIM_SMILE, "mouthUpperUp", 0.1, 0.4},      {SIM_SMILE, "jawOpen", 0.0, 0.2},
    {SIM_MOUTH_WIDE, "jawOpen", 0.7, 1.0},      {SIM_MOUTH_WIDE, "mouthStretch", 0.0, 0.4},
    {SIM_MOUTH_HALF, "jawOpen", 0.4, 0.6},      {SIM_EYES_CLOSED, "eyeBlink", 0.95, 1.0},
    {SIM_EYES_CLOSED, "cheekSquint", 0.0, 0.3}, {SIM_FROWN, "mouthFrown", 0.6, 1.0},
    {SIM_FROWN, "browDown", 0.6, 1.0},          {SIM_FROWN, "mouthShrugLower", 0.2, 0.6},
    {SIM_PUCKER, "mouthPucker", 0.6, 1.0},      {SIM_PUCKER, "mouthFunnel", 0.0, 0.3},
    {SIM_CHEEK_PUFF, "cheekPuff", 0.6, 1.0},    {SIM_CHEEK_PUFF, "mouthPress", 0.2, 0.6},
    {SIM_SQUINT, "eyeSquint", 0.7, 1.0},        {SIM_SQUINT, "browDown", 0.4, 0.8},
    {SIM_SQUINT, "cheekSquint", 0.4, 0.8},      {SIM_DISGUST, "noseSneer", 0.6, 1.0},
    {SIM_DISGUST, "mouthUpperUp", 0.4, 0.9},    {SIM_DISGUST, "browDown", 0.3, 0.7},
    {SIM_SURPRISE, "browInnerUp", 0.6, 1.0},    {SIM_SURPRISE, "browOuterUp", 0.6, 1.0},
    {SIM_SURPRISE, "eyeWide", 0.5, 1.0},        {SIM_SURPRISE, "jawOpen", 0.3, 0.6},
};

static const enum sim_expression strong_ones[] = {
    SIM_SMILE,  SIM_MOUTH_WIDE, SIM_MOUTH_HALF, SIM_EYES_CLOSED, SIM_FROWN,
    SIM_PUCKER, SIM_CHEEK_PUFF, SIM_SQUINT,     SIM_DISGUST,     SIM_SURPRISE,
};

const char *sim_expression_name(enum sim_expression expression)
{
    static const char *const names[SIM_EXPRESSIONS] = {
        "neutral", "mild",   "strong",     "smile",  "mouth-wide", "mouth-half", "eyes-closed",
        "frown",   "pucker", "cheek-puff", "squint", "disgust",    "surprise",
    };
    return (unsigned)expression < SIM_EXPRESSIONS ? names[expression] : NULL;
}

/* Shapes that move in a face at rest. Gaze and pupils are left out, because a depth sensor does
 * not see them; mouthClose is left out, because it only makes sense with an open jaw. */
static bool moves_at_rest(const char *name)
{
    return strncmp(name, "eyeLook", 7) != 0 && strncmp(name, "Pupil", 5) != 0 &&
           strcmp(name, "mouthClose") != 0;
}

static double clamped(double weight)
{
    return fmin(fmax(weight, 0.0), 1.0);
}

static void add_half(const struct sim_ict *ict, const char *stem, const char *side, double weight,
                     double *weights)
{
    char name[32];
    (void)snprintf(name, sizeof name, "%s%s", stem, side);
    const int shape = sim_ict_expression(ict, name);
    if (shape >= 0) {
        weights[shape] = clamped(weights[shape] + weight);
    }
}

enum sim_expression sim_expression_draw(const struct sim_ict *ict, enum sim_expression expression,
                                        struct sim_random *random, double *weights)
{
    if (expression == SIM_STRONG) {
        const uint32_t n = sizeof strong_ones / sizeof *strong_ones;
        expression = strong_ones[sim_random_below(random, n)];
    }
    for (uint32_t i = 0; i < ict->n_expression; i++) {
        const double jitter = fabs(rest_jitter * sim_random_normal(random));
        weights[i] = moves_at_rest(ict->expression_names[i]) ? jitter : 0.0;
    }
    for (size_t i = 0; i < sizeof components / sizeof *components; i++) {
        const struct component *c = &components[i];
        if (c->expression != expression) {
            continue;
        }
        const double weight = sim_random_between(random, c->from, c->to);
        add_half(ict, c->name, "", weight, weights);
        add_half(ict, c->name, "_L", weight * (1.0 + asymmetry * sim_random_normal(random)),
                 weights);
        add_half(ict, c->name, "_R", weight * (1.0 + asymmetry * sim_random_normal(random)),
                 weights);
    }
    return expression;
}
