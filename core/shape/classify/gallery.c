#include "core/shape/classify/gallery.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

int iso_gallery_init(struct iso_gallery *gallery, const struct iso_labelled *training)
{
    size_t n = (size_t)training->n, values = n * (size_t)training->layout->size;
    struct iso_gallery g = {*training->layout, training->n, training->n_classes, NULL, NULL};
    g.feature = malloc(values * sizeof *g.feature);
    g.label = malloc(n * sizeof *g.label);
    if (!g.feature || !g.label) {
        iso_gallery_done(&g);
        return -ENOMEM;
    }
    memcpy(g.feature, training->feature, values * sizeof *g.feature);
    memcpy(g.label, training->label, n * sizeof *g.label);
    *gallery = g;
    return 0;
}

void iso_gallery_done(struct iso_gallery *gallery)
{
    free(gallery->feature);
    free(gallery->label);
    *gallery = (struct iso_gallery){0};
}

void iso_gallery_normalise(const struct iso_feature_layout *layout, float *feature)
{
    for (int32_t p = 0; p < layout->n_parts; p++) {
        double square = 0.0;
        for (int32_t i = 0; i < layout->part_size[p]; i++) {
            square += (double)feature[i] * (double)feature[i];
        }
        for (int32_t i = 0; square > 0.0 && i < layout->part_size[p]; i++) {
            feature[i] = (float)((double)feature[i] / sqrt(square));
        }
        feature += layout->part_size[p];
    }
}

void iso_gallery_score(const struct iso_gallery *gallery, const double *distance, double *score)
{
    for (int32_t c = 0; c < gallery->n_classes; c++) {
        score[c] = -INFINITY;
    }
    for (int32_t i = 0; i < gallery->n; i++) {
        score[gallery->label[i]] = fmax(score[gallery->label[i]], -distance[i]);
    }
}
