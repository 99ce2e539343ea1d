/* Decision trees: CART; the dissertation uses C4.5. */
#include <errno.h>
#include <stdlib.h>

#include "sim/shapes/learn/ops.h"
#include "sim/shapes/learn/tree.h"

struct machine {
    int32_t n_classes;
    struct iso_tree *tree;
};

static int train(const struct iso_labelled *training, void **model)
{
    struct machine *m = calloc(1, sizeof *m);
    if (!m) {
        return -ENOMEM;
    }
    m->n_classes = training->n_classes;
    const int error = iso_tree_new(training->feature, training->label, training->n,
                                   training->layout->size, &m->tree);
    if (error) {
        free(m);
        return error;
    }
    *model = m;
    return 0;
}

static void release(void *model)
{
    struct machine *m = model;
    iso_tree_free(m->tree);
    free(m);
}

/* A tree predicts a class without a confidence, so the score is 1 for this class and 0 for all
 * others. */
static int score(const void *model, const float *feature, double *score)
{
    const struct machine *m = model;
    int32_t told = 0;
    const int error = iso_tree_tell(m->tree, feature, &told);
    for (int32_t c = 0; !error && c < m->n_classes; c++) {
        score[c] = c == told ? 1.0 : 0.0;
    }
    return error;
}

const struct iso_classifier_ops iso_learn_decision_tree = {
    .name = "decision-tree",
    .title = "Decision tree",
    .source = "Breiman, Friedman, Olshen and Stone 1984 (CART, OpenCV)",
    .train = train,
    .free = release,
    .score = score,
};
