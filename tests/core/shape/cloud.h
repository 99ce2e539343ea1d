/* Features of known classes for the tests of classifiers: points about three places, a class each.
 */
#ifndef TESTS_CORE_SHAPE_CLOUD_H
#define TESTS_CORE_SHAPE_CLOUD_H

#include "isotherm/classifier.h"

enum { CLASSES = 3, EACH = 8, N = CLASSES * EACH, SIZE = 12 };

struct cloud {
    float feature[N][SIZE]; /* in two parts, of 8 and 4 values */
    int32_t label[N];
    struct iso_labelled all; /* of them; points into the cloud that was made */
};

/* Makes a cloud. The second part of each feature has the noise `noise_of_second`. */
void make_cloud(struct cloud *c, double noise, double noise_of_second);

/* Lets c->all say what c->feature and c->label are. */
void label_cloud(struct cloud *c);

/* How many items have their highest score [N][CLASSES] for their own class. */
int right_ones(const double *score, const int32_t *label);

#endif
