#include "core/shape/classify/collaborative.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The parts of a feature for which dictionaries are built: the whole feature as one part if the
 * method codes all parts together, otherwise the parts of the layout. */
static struct iso_feature_layout parts_of(const struct iso_collaborative_kind *kind,
                                          const struct iso_feature_layout *layout)
{
    return kind->joined ? (struct iso_feature_layout){layout->size, 1, {layout->size}} : *layout;
}

/* Scales each part of the feature to unit length. If the method codes all parts together, it then
 * scales the whole feature to unit length. */
static void unit_length(const struct iso_collaborative_kind *kind,
                        const struct iso_feature_layout *layout, float *feature)
{
    iso_training_set_normalise(layout, feature);
    if (kind->joined) {
        const struct iso_feature_layout whole = parts_of(kind, layout);
        iso_training_set_normalise(&whole, feature);
    }
}

/* ---- learning ---- */

void iso_collaborative_free(void *model)
{
    struct iso_collaborative *m = model;
    for (int32_t k = 0; k < m->n_parts; k++) {
        iso_dictionary_done(&m->part[k]);
    }
    iso_training_set_done(&m->gallery);
    free(m);
}

int iso_collaborative_train(const struct iso_collaborative_kind *kind,
                            const struct iso_labelled *training, void **model)
{
    struct iso_collaborative *m = calloc(1, sizeof *m);
    if (!m) {
        return -ENOMEM;
    }
    m->kind = kind;
    const int32_t size = training->layout->size;
    const struct iso_feature_layout parts = parts_of(kind, training->layout);
    int error = iso_training_set_init(&m->gallery, training);
    for (int32_t i = 0; !error && i < training->n; i++) {
        unit_length(kind, training->layout, &m->gallery.feature[(size_t)i * (size_t)size]);
    }
    const float *atom = m->gallery.feature;
    for (int32_t k = 0; !error && k < parts.n_parts; k++) {
        error = iso_dictionary_init(&m->part[k], atom, training->n, parts.part_size[k], size);
        m->n_parts += !error;
        atom += parts.part_size[k];
    }
    if (error) {
        iso_collaborative_free(m);
        return error;
    }
    *model = m;
    return 0;
}

/* ---- a query's codes ---- */

/* The memory that a code points into. */
struct room {
    float *features; /* y, residual */
    double *numbers;
};

static void room_done(struct room *room)
{
    free(room->features);
    free(room->numbers);
}

static int code_init(const struct iso_collaborative *m, struct room *room, struct iso_code *code)
{
    const size_t n = (size_t)m->gallery.n, size = (size_t)m->gallery.layout.size;
    const size_t parts = (size_t)m->n_parts;
    room->features = malloc(2 * size * sizeof *room->features);
    room->numbers = calloc((2 * parts + 4) * n, sizeof *room->numbers);
    if (!room->features || !room->numbers) {
        room_done(room);
        return -ENOMEM;
    }
    const float *y = room->features;
    for (size_t k = 0; k < parts; k++) {
        code->y[k] = y;
        code->product[k] = &room->numbers[2 * k * n];
        code->alpha[k] = &room->numbers[(2 * k + 1) * n];
        y += m->part[k].size;
    }
    code->mean = &room->numbers[2 * parts * n];
    code->right = code->mean + n;
    code->scratch = code->right + n;
    code->residual = room->features + size;
    return 0;
}

static int find_code(const struct iso_collaborative *m, const float *feature, int32_t left,
                     struct room *room, struct iso_code *code)
{
    *code = (struct iso_code){.left = left};
    const int error = code_init(m, room, code);
    if (error) {
        return error;
    }
    memcpy(room->features, feature, (size_t)m->gallery.layout.size * sizeof *feature);
    unit_length(m->kind, &m->gallery.layout, room->features);
    for (int32_t k = 0; k < m->n_parts; k++) {
        iso_dictionary_products(&m->part[k], code->y[k], code->product[k]);
    }
    m->kind->find(m, code);
    return 0;
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

static bool is_present(const struct iso_training_set *gallery, int32_t class)
{
    int32_t i = 0;
    while (i < gallery->n && gallery->label[i] != class) {
        i++;
    }
    return i < gallery->n;
}

int iso_collaborative_score(const void *model, const float *feature, double *score)
{
    const struct iso_collaborative *m = model;
    struct room room;
    struct iso_code code;
    const int error = find_code(m, feature, -1, &room, &code);
    if (error) {
        return error;
    }
    for (int32_t c = 0; c < m->gallery.n_classes; c++) {
        score[c] = is_present(&m->gallery, c) ? m->kind->score(m, &code, c) : -INFINITY;
    }
    room_done(&room);
    return 0;
}

int iso_collaborative_rank(const void *model, const float *feature, int32_t left, double *distance)
{
    const struct iso_collaborative *m = model;
    struct room room;
    struct iso_code code;
    const int error = find_code(m, feature, left, &room, &code);
    if (error) {
        return error;
    }
    double weight = 0.0;
    for (int32_t k = 0; k < m->n_parts; k++) {
        weight += code.weight[k];
    }
    for (int32_t i = 0; i < m->gallery.n; i++) {
        double square = 0.0;
        for (int32_t k = 0; i != left && k < m->n_parts; k++) {
            const double a = code.alpha[k][i];
            square += code.weight[k] / weight * (1.0 - 2.0 * a * code.product[k][i] + a * a);
        }
        distance[i] = sqrt(fmax(0.0, square));
    }
    room_done(&room);
    return 0;
}
