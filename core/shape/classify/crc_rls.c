/* Collaborative representation based classification with regularised least squares (Zhang, Yang and
 * Feng, "Sparse representation or collaborative representation: which helps face recognition?",
 * ICCV 2011): y is coded over all shapes of all classes, and belongs to the class whose shapes
 * represent it best in that code. */
#include <math.h>

#include "core/shape/classify/collaborative.h"

static void find(const struct iso_collaborative *m, struct iso_code *code)
{
    iso_dictionary_solve(&m->part[0], m->lambda, code->product[0], code->left, code->scratch,
                         code->alpha[0]);
    code->weight[0] = 1.0;
}

/* The score -|y - D_c alpha_c| / |alpha_c|. */
static double score(const struct iso_collaborative *m, const struct iso_code *code, int32_t class)
{
    double square = 0.0;
    for (int32_t i = 0; i < m->gallery.n; i++) {
        const double a = m->gallery.label[i] == class ? code->alpha[0][i] : 0.0;
        square += a * a;
    }
    return square > 0.0 ? -sqrt(iso_code_residual(m, code, 0, class) / square) : -INFINITY;
}

static int train(const struct iso_labelled *training, void **model)
{
    static const struct iso_collaborative_kind kind = {
        .joined = true, .find = find, .score = score};
    return iso_collaborative_train(&kind, training, model);
}

const struct iso_classifier_ops iso_classifier_crc_rls = {
    .name = "crc-rls",
    .title = "CRC-RLS",
    .source = "Zhang, Yang and Feng 2011; Abdelrahman 2013, 4.2.2",
    .train = train,
    .free = iso_collaborative_free,
    .score = iso_collaborative_score,
    .rank = iso_collaborative_rank,
};
