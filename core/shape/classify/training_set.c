#include "core/shape/classify/training_set.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

int iso_training_set_init(struct iso_training_set *gallery, const struct iso_labelled *training)
{
    size_t n = (size_t)training->n, values = n * (size_t)training->layout->size;
    struct iso_training_set g = {*training->layout, training->n, training->n_classes, NULL, NULL};
    g.feature = malloc(values * sizeof *g.feature);
    g.label = malloc(n * sizeof *g.label);
    if (!g.feature || !g.label) {
        iso_training_set_done(&g);
        return -ENOMEM;
    }
    memcpy(g.feature, training->feature, values * sizeof *g.feature);
    memcpy(g.label, training->label, n * sizeof *g.label);
    *gallery = g;
    return 0;
}

void iso_training_set_done(struct iso_training_set *gallery)
{
    free(gallery->feature);
    free(gallery->label);
    *gallery = (struct iso_training_set){0};
}

void iso_training_set_score(const struct iso_training_set *gallery, const double *distance,
                            double *score)
{
    for (int32_t c = 0; c < gallery->n_classes; c++) {
        score[c] = -INFINITY;
    }
    for (int32_t i = 0; i < gallery->n; i++) {
        score[gallery->label[i]] = fmax(score[gallery->label[i]], -distance[i]);
    }
}
