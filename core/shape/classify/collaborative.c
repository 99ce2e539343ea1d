#include "core/shape/classify/collaborative.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- learning ---- */

/* The parts of a feature for which dictionaries are built: the whole feature as one part if the
 * method codes all parts together, otherwise the parts of the layout. */
static struct iso_feature_layout parts_of(const struct iso_collaborative_kind *kind,
                                          const struct iso_feature_layout *layout)
{
    return kind->joined ? (struct iso_feature_layout){layout->size, 1, {layout->size}, layout->norm}
                        : *layout;
}

static void drop_dictionaries(struct iso_collaborative *m)
{
    for (int32_t k = 0; k < m->n_parts; k++) {
        iso_dictionary_done(&m->part[k]);
    }
    m->n_parts = 0;
    iso_training_set_done(&m->gallery);
    iso_standard_done(&m->standard);
}

void iso_collaborative_free(void *model)
{
    drop_dictionaries(model);
    free(model);
}

/* Makes standard, gallery and dictionaries anew. A dictionary's atoms have length 1 in the root
 * mean square, so that the same lambda means the same for one dictionary and for several. */
static int make_dictionaries(struct iso_collaborative *m, const struct iso_labelled *training,
                             enum iso_compression compression)
{
    const int32_t size = training->layout->size;
    const struct iso_feature_layout parts = parts_of(m->kind, training->layout);
    drop_dictionaries(m);
    int error = iso_standard_init(&m->standard, training, compression, sqrt(parts.n_parts));
    if (!error) {
        error = iso_training_set_init(&m->gallery, training);
    }
    for (int32_t i = 0; !error && i < training->n; i++) {
        iso_standard_apply(&m->standard, &m->gallery.feature[(size_t)i * (size_t)size]);
    }
    const float *atom = m->gallery.feature;
    for (int32_t k = 0; !error && k < parts.n_parts; k++) {
        error = iso_dictionary_init(&m->part[k], atom, training->n, parts.part_size[k], size);
        m->n_parts += !error;
        atom += parts.part_size[k];
    }
    return error;
}

/* Tries each way to compress the features, and keeps the best one with its lambda. */
static int learn(struct iso_collaborative *m, const struct iso_labelled *training)
{
    if (!iso_standard_compressible(training)) {
        double quality;
        const int error = make_dictionaries(m, training, ISO_COMPRESSION_NONE);
        return error ? error : iso_collaborative_choose(m, &quality);
    }
    double root = 0.0, logarithm = 0.0;
    int error = make_dictionaries(m, training, ISO_COMPRESSION_ROOT);
    if (!error) {
        error = iso_collaborative_choose(m, &root);
    }
    const double lambda = m->lambda;
    if (!error) {
        error = make_dictionaries(m, training, ISO_COMPRESSION_LOGARITHM);
    }
    if (!error) {
        error = iso_collaborative_choose(m, &logarithm);
    }
    if (!error && logarithm <= root + ISO_COLLABORATIVE_GAIN) {
        m->lambda = lambda;
        error = make_dictionaries(m, training, ISO_COMPRESSION_ROOT);
    }
    return error;
}

int iso_collaborative_train(const struct iso_collaborative_kind *kind,
                            const struct iso_labelled *training, void **model)
{
    struct iso_collaborative *m = calloc(1, sizeof *m);
    if (!m) {
        return -ENOMEM;
    }
    m->kind = kind;
    const int error = learn(m, training);
    if (error) {
        iso_collaborative_free(m);
        return error;
    }
    *model = m;
    return 0;
}

/* ---- a query's codes ---- */

void iso_code_done(struct iso_code_work *work)
{
    free(work->features);
    free(work->numbers);
}

int iso_code_init(const struct iso_collaborative *m, struct iso_code_work *work,
                  struct iso_code *code)
{
    const size_t n = (size_t)m->gallery.n, size = (size_t)m->gallery.layout.size;
    const size_t parts = (size_t)m->n_parts;
    work->features = malloc(2 * size * sizeof *work->features);
    work->numbers = calloc((2 * parts + 4) * n, sizeof *work->numbers);
    if (!work->features || !work->numbers) {
        iso_code_done(work);
        return -ENOMEM;
    }
    *code = (struct iso_code){.left = -1};
    const float *y = work->features;
    for (size_t k = 0; k < parts; k++) {
        code->y[k] = y;
        code->product[k] = &work->numbers[2 * k * n];
        code->alpha[k] = &work->numbers[(2 * k + 1) * n];
        y += m->part[k].size;
    }
    code->mean = &work->numbers[2 * parts * n];
    code->right = code->mean + n;
    code->scratch = code->right + n;
    code->residual = work->features + size;
    return 0;
}

void iso_code_find(const struct iso_collaborative *m, const float *feature, int32_t left,
                   const struct iso_code_work *work, struct iso_code *code)
{
    code->left = left;
    memcpy(work->features, feature, (size_t)m->gallery.layout.size * sizeof *feature);
    for (int32_t k = 0; k < m->n_parts; k++) {
        iso_dictionary_products(&m->part[k], code->y[k], code->product[k]);
    }
    m->kind->find(m, code);
}

/* The same for a feature as it comes, with memory of its own. */
static int find_code(const struct iso_collaborative *m, const float *feature, int32_t left,
                     struct iso_code_work *work, struct iso_code *code)
{
    const size_t bytes = (size_t)m->gallery.layout.size * sizeof *feature;
    float *own = malloc(bytes);
    const int error = own ? iso_code_init(m, work, code) : -ENOMEM;
    if (!error) {
        memcpy(own, feature, bytes);
        iso_standard_apply(&m->standard, own);
        iso_code_find(m, own, left, work, code);
    }
    free(own);
    return error;
}

double iso_code_residual(const struct iso_collaborative *m, const struct iso_code *code, int32_t k,
                         int32_t class)
{
    const struct iso_dictionary *d = &m->part[k];
    double square = 0.0;
    memcpy(code->residual, code->y[k], (size_t)d->size * sizeof *code->residual);
    for (int32_t i = 0; i < d->n; i++) {
        const float *atom = &d->atom[(size_t)i * (size_t)d->stride];
        for (int32_t j = 0; m->gallery.label[i] == class && j < d->size; j++) {
            code->residual[j] -= (float)code->alpha[k][i] * atom[j];
        }
    }
    for (int32_t j = 0; j < d->size; j++) {
        square += (double)code->residual[j] * (double)code->residual[j];
    }
    return square;
}

/* ---- scores and distances ---- */

static bool is_present(const struct iso_training_set *gallery, int32_t class, int32_t left)
{
    int32_t i = 0;
    while (i < gallery->n && (i == left || gallery->label[i] != class)) {
        i++;
    }
    return i < gallery->n;
}

void iso_code_scores(const struct iso_collaborative *m, const struct iso_code *code, double *score)
{
    for (int32_t c = 0; c < m->gallery.n_classes; c++) {
        const bool present = is_present(&m->gallery, c, code->left);
        score[c] = present ? m->kind->score(m, code, c) : -INFINITY;
    }
}

/* What the contribution a d of a shape adds to |y|^2, given d y and |d|^2. A shape with a negative
 * coefficient differs from the mean in the opposite direction: it only makes the distance longer.
 */
static double contribution(double a, double product, double square)
{
    const double along = a < 0.0 ? fabs(product) : product;
    return a * a * square - 2.0 * a * along;
}

void iso_code_distances(const struct iso_collaborative *m, const struct iso_code *code,
                        double *distance)
{
    double weight = 0.0, length[ISO_SHAPE_PARTS_MAX] = {0.0};
    for (int32_t k = 0; k < m->n_parts; k++) {
        weight += code->weight[k];
        for (int32_t j = 0; j < m->part[k].size; j++) {
            length[k] += (double)code->y[k][j] * (double)code->y[k][j];
        }
    }
    for (int32_t i = 0; i < m->gallery.n; i++) {
        double square = 0.0;
        for (int32_t k = 0; i != code->left && k < m->n_parts; k++) {
            square += code->weight[k] / weight *
                      (length[k] +
                       contribution(code->alpha[k][i], code->product[k][i], m->part[k].square[i]));
        }
        distance[i] = sqrt(fmax(0.0, square));
    }
}

int iso_collaborative_score(const void *model, const float *feature, double *score)
{
    struct iso_code_work work;
    struct iso_code code;
    const int error = find_code(model, feature, -1, &work, &code);
    if (!error) {
        iso_code_scores(model, &code, score);
        iso_code_done(&work);
    }
    return error;
}

int iso_collaborative_rank(const void *model, const float *feature, int32_t left, double *distance)
{
    struct iso_code_work work;
    struct iso_code code;
    const int error = find_code(model, feature, left, &work, &code);
    if (!error) {
        iso_code_distances(model, &code, distance);
        iso_code_done(&work);
    }
    return error;
}
