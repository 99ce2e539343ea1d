#include "isotherm/classifier.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/shape/classify/training_set.h"

const struct iso_classifier_ops *const iso_classifiers[] = {
    &iso_classifier_nn_l1,
    &iso_classifier_nn_l2,
    &iso_classifier_crc_rls,
    &iso_classifier_rcr,
    &iso_classifier_naive_bayes,
    &iso_classifier_nn,
    NULL,
};

struct iso_classifier {
    const struct iso_classifier_ops *ops;
    void *model;
};

static bool is_valid(const struct iso_labelled *l)
{
    if (l->n < 1 || l->n_classes < 2 || l->layout->size < 1) {
        return false;
    }
    for (int32_t i = 0; i < l->n; i++) {
        if (l->label[i] < 0 || l->label[i] >= l->n_classes) {
            return false;
        }
    }
    const size_t values = (size_t)l->n * (size_t)l->layout->size;
    for (size_t i = 0; i < values; i++) {
        if (!isfinite(l->feature[i])) {
            return false;
        }
    }
    return true;
}

int iso_classifier_new(const struct iso_classifier_ops *ops, const struct iso_labelled *training,
                       struct iso_classifier **out)
{
    if (!is_valid(training)) {
        return -EINVAL;
    }
    struct iso_classifier *c = calloc(1, sizeof *c);
    if (!c) {
        return -ENOMEM;
    }
    c->ops = ops;
    const int error = ops->train(training, &c->model);
    if (error) {
        free(c);
        return error;
    }
    *out = c;
    return 0;
}

void iso_classifier_free(struct iso_classifier *classifier)
{
    if (classifier) {
        classifier->ops->free(classifier->model);
        free(classifier);
    }
}

int iso_classifier_score(const struct iso_classifier *classifier, const float *feature,
                         double *score)
{
    return classifier->ops->score(classifier->model, feature, score);
}

int iso_classifier_rank(const struct iso_classifier *classifier, const float *feature, int32_t left,
                        double *distance)
{
    return classifier->ops->rank ? classifier->ops->rank(classifier->model, feature, left, distance)
                                 : -ENOSYS;
}
