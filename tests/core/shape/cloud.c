#include "tests/core/shape/cloud.h"

#include <math.h>
#include <stdlib.h>

static const struct iso_feature_layout layout = {SIZE, 2, {8, 4}, ISO_NORM_L1};

void label_cloud(struct cloud *c)
{
    c->all = (struct iso_labelled){&layout, N, CLASSES, c->feature[0], c->label};
}

void make_cloud(struct cloud *c, double noise, double noise_of_second)
{
    srand48(97);
    for (int i = 0; i < N; i++) {
        c->label[i] = i % CLASSES;
        for (int k = 0; k < SIZE; k++) {
            double spread = k < 8 ? noise : noise_of_second;
            c->feature[i][k] = (float)(1.0 + cos(1.3 * k * (c->label[i] + 1)) +
                                       spread * (drand48() - 0.5));
        }
    }
    label_cloud(c);
}

static int32_t told(const double *score)
{
    int32_t best = 0;
    for (int32_t k = 1; k < CLASSES; k++) {
        best = score[k] > score[best] ? k : best;
    }
    return best;
}

int right_ones(const double *score, const int32_t *label)
{
    int right = 0;
    for (int i = 0; i < N; i++) {
        right += told(&score[i * CLASSES]) == label[i];
    }
    return right;
}
