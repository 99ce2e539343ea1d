#include "sim/train/head/train_head.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "sim/base/progress.h"
#include "sim/train/head/decimate.h"
#include "sim/train/head/head_exposure.h"
#include "sim/train/head/head_region.h"
#include "sim/train/head/head_surface.h"
#include "sim/train/head/train_measure.h"
#include "sim/train/principal.h"
#include "sim/world/face/expression.h"
#include "sim/world/face/person.h"

enum { EXPRESSIONS_DRAWN = 2000 };

/* The working data. Arrays are over the vertices of the coarse surface unless stated otherwise. */
struct training {
    const struct sim_ict *ict;
    const struct sim_train_head_options *options;
    struct sim_train_head_report report;
    struct sim_head_surface *fine, *coarse;
    float *identity_mm, *expression_mm; /* all fields of `ict`, [n][n_vertices][3] */
    double *moment;                     /* [ict->n_expression]^2, of the expression weights */
    double *exposure, *expression_rms_mm, *face_area_mm2, *rigid_area_mm2;
    uint8_t *region;
    double identity_variance[SIM_FIELDS_MAX], expression_variance[SIM_FIELDS_MAX];
    struct iso_head_model *model;
};

struct sim_train_head_options sim_train_head_options_default(void)
{
    return (struct sim_train_head_options){
        .seed = 1, .n_vertices = 1180, .n_identity = 60, .n_expression = 12};
}

/* `exposure` is for the fine surface, which `coarse` still equals at the start. */
static int decimate_mesh(struct training *t, const double *exposure)
{
    struct sim_head_surface *s = t->coarse;
    uint8_t *keep = calloc(s->n_vertices, sizeof *keep);
    double *importance = calloc(s->n_vertices, sizeof *importance);
    int error = -ENOMEM;
    if (keep && importance) {
        for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
            keep[s->landmarks[i]] = 1;
        }
        sim_head_importance(s, exposure, importance);
        struct sim_decimate_options options = {
            .n_target = t->options->n_vertices, .keep = keep, .importance = importance};
        error = sim_decimate(s->mean_mm, s->n_vertices, &options, s->triangles, &s->n_triangles);
    }
    free(importance);
    free(keep);
    if (error) {
        return error;
    }
    return sim_head_surface_compact(s);
}

static void report_decimation(struct training *t, const struct sim_distances *distances)
{
    t->report.n_fine_vertices = t->fine->n_vertices;
    t->report.decimation_mean_mm = distances->mean_mm;
    t->report.decimation_p95_mm = distances->p95_mm;
    t->report.decimation_max_mm = distances->max_mm;
}

static int make_surfaces(struct training *t, struct iso_fault *fault)
{
    int error = sim_head_surface_new(t->ict, &t->fine, fault);
    if (!error) {
        error = sim_head_surface_new(t->ict, &t->coarse, fault);
    }
    if (error) {
        return error;
    }
    double *exposure = calloc(t->fine->n_vertices, sizeof *exposure);
    error = exposure ? sim_head_exposure(t->fine, exposure) : -ENOMEM;
    if (!error) {
        error = decimate_mesh(t, exposure);
    }
    struct sim_distances distances;
    if (!error) {
        error = sim_surface_distances(t->fine, exposure, t->coarse, &distances);
    }
    free(exposure);
    if (error) {
        return iso_fault_set(fault, error, "head model: cannot be decimated");
    }
    report_decimation(t, &distances);
    return 0;
}

static int allocate_arrays(struct training *t)
{
    const size_t n = t->coarse->n_vertices, n_shapes = t->ict->n_expression;
    t->identity_mm = calloc(t->ict->n_identity * n * 3, sizeof *t->identity_mm);
    t->expression_mm = calloc(n_shapes * n * 3, sizeof *t->expression_mm);
    t->moment = calloc(n_shapes * n_shapes, sizeof *t->moment);
    t->exposure = calloc(n, sizeof *t->exposure);
    t->expression_rms_mm = calloc(n, sizeof *t->expression_rms_mm);
    t->face_area_mm2 = calloc(n, sizeof *t->face_area_mm2);
    t->rigid_area_mm2 = calloc(n, sizeof *t->rigid_area_mm2);
    t->region = calloc(n, sizeof *t->region);
    return t->identity_mm && t->expression_mm && t->moment && t->exposure && t->expression_rms_mm &&
                   t->face_area_mm2 && t->rigid_area_mm2 && t->region
               ? 0
               : -ENOMEM;
}

/* Evaluates fields of the statistical head model at the vertices of the coarse surface. */
static void carry_fields(const struct training *t, const float *from_mm, uint32_t n_fields,
                         float *to_mm)
{
    const size_t stride = 3 * (size_t)t->coarse->n_vertices;
    for (uint32_t m = 0; m < n_fields; m++) {
        sim_head_surface_displacement(t->coarse, from_mm + 3 * (size_t)m * t->ict->n_vertices,
                                      (float(*)[3])(to_mm + m * stride));
    }
}

/* Computes the second moments of the expression weights of people at a door: one fifth at rest,
 * two fifths with a mild and two fifths with a strong expression. The moments are about zero, not
 * about the mean, because zero weights are the neutral face. */
static void draw_expressions(struct training *t)
{
    static const enum sim_expression mix[] = {SIM_NEUTRAL, SIM_MILD, SIM_MILD, SIM_STRONG,
                                              SIM_STRONG};
    enum { MIX = sizeof mix / sizeof mix[0] };
    const uint32_t n = t->ict->n_expression;
    const uint64_t stream = sim_random_hash(SIM_POPULATION_TRAIN);
    for (uint32_t i = 0; i < EXPRESSIONS_DRAWN; i++) {
        double weight[SIM_EXPRESSION_SHAPES_MAX];
        struct sim_random random = sim_random_seeded(t->options->seed, stream, i);
        (void)sim_expression_draw(t->ict, mix[i % MIX], &random, weight);
        for (uint32_t j = 0; j < n * n; j++) {
            t->moment[j] += weight[j / n] * weight[j % n] / EXPRESSIONS_DRAWN;
        }
    }
}

static struct iso_vec3 vertex_normal(const struct sim_head_surface *s, uint32_t vertex)
{
    struct iso_vec3 sum = {0.0, 0.0, 0.0};
    for (uint32_t t = 0; t < s->n_triangles; t++) {
        const uint32_t *v = s->triangles[t];
        if (v[0] == vertex || v[1] == vertex || v[2] == vertex) {
            struct iso_vec3 a = s->mean_mm[v[0]];
            sum = iso_add(sum,
                          iso_cross(iso_sub(s->mean_mm[v[1]], a), iso_sub(s->mean_mm[v[2]], a)));
        }
    }
    return iso_unit(sum);
}

/* Measures the movement of each vertex along its normal, rms over the drawn expressions. */
static void measure_expressions(struct training *t)
{
    const uint32_t n = t->ict->n_expression, n_vertices = t->coarse->n_vertices;
    for (uint32_t v = 0; v < n_vertices; v++) {
        struct iso_vec3 normal = vertex_normal(t->coarse, v);
        double along[SIM_EXPRESSION_SHAPES_MAX], sum = 0.0;
        for (uint32_t i = 0; i < n; i++) {
            const float *d = t->expression_mm + 3 * ((size_t)i * n_vertices + v);
            along[i] = iso_dot(normal, iso_vec3((double)d[0], (double)d[1], (double)d[2]));
        }
        for (uint32_t j = 0; j < n * n; j++) {
            sum += t->moment[j] * along[j / n] * along[j % n];
        }
        t->expression_rms_mm[v] = sqrt(fmax(sum, 0.0));
    }
}

static int mark_regions(struct training *t)
{
    const int error = sim_head_exposure(t->coarse, t->exposure);
    if (error) {
        return error;
    }
    measure_expressions(t);
    sim_head_regions(t->coarse, t->exposure, t->expression_rms_mm, t->region);
    sim_head_vertex_areas(t->coarse, t->region, ISO_HEAD_FACE, t->face_area_mm2);
    sim_head_vertex_areas(t->coarse, t->region, ISO_HEAD_RIGID, t->rigid_area_mm2);
    for (uint32_t v = 0; v < t->coarse->n_vertices; v++) {
        t->report.n_face += (t->region[v] & ISO_HEAD_FACE) != 0;
        t->report.n_rigid += (t->region[v] & ISO_HEAD_RIGID) != 0;
    }
    return 0;
}

static double sum_of(const double *values, uint32_t n)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        sum += values[i];
    }
    return sum;
}

static int find_modes(struct training *t)
{
    const struct sim_ict *ict = t->ict;
    const struct iso_vec3 *mean = t->coarse->mean_mm;
    const uint32_t n = t->coarse->n_vertices;
    int error = sim_remove_rigid(mean, n, t->rigid_area_mm2, ict->n_identity, t->identity_mm);
    if (!error) {
        error = sim_remove_rigid(mean, n, t->rigid_area_mm2, ict->n_expression, t->expression_mm);
    }
    if (!error) {
        error = sim_principal(t->identity_mm, ict->n_identity, n, t->face_area_mm2, NULL,
                              t->model->n_identity, t->model->identity_mm, t->identity_variance);
    }
    if (!error) {
        error = sim_principal(t->expression_mm, ict->n_expression, n, t->face_area_mm2, t->moment,
                              t->model->n_expression, t->model->expression_mm,
                              t->expression_variance);
    }
    return error;
}

static int measure_modes(struct training *t)
{
    struct sim_train_head_report *report = &t->report;
    const struct iso_head_model *model = t->model;
    const double area = sum_of(t->face_area_mm2, model->n_vertices);
    const double identity = sum_of(t->identity_variance, t->ict->n_identity);
    const double expression = sum_of(t->expression_variance, t->ict->n_expression);
    const double expression_kept = sum_of(t->expression_variance, model->n_expression);
    report->identity_explained = sum_of(t->identity_variance, model->n_identity) / identity;
    report->expression_explained = expression_kept / expression;
    report->expression_rms_mm = sqrt(expression / area);
    report->expression_left_rms_mm = sqrt(fmax(expression - expression_kept, 0.0) / area);
    struct sim_rms unseen;
    const int error = sim_unseen_people(t->identity_mm, model->n_vertices, t->face_area_mm2,
                                        model->identity_mm, t->identity_variance, model->n_identity,
                                        t->options->seed, &unseen);
    if (!error) {
        report->identity_rms_mm = unseen.before_mm;
        report->unseen_rms_mm = unseen.after_mm;
    }
    return error;
}

/* The point at a vertex: a corner of the first triangle that has this vertex. */
static struct iso_head_point point_at_vertex(const struct sim_head_surface *surface, uint32_t v)
{
    for (uint32_t t = 0; t < surface->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            if (surface->triangles[t][k] == v) {
                struct iso_head_point point = {.triangle = t};
                point.weight[k] = 1.0f;
                return point;
            }
        }
    }
    return (struct iso_head_point){0}; /* unreachable: compact surfaces have no loose vertices */
}

static void fill_in_mesh(const struct training *t)
{
    const struct sim_head_surface *s = t->coarse;
    for (uint32_t i = 0; i < s->n_vertices; i++) {
        t->model->mean_mm[i] = s->mean_mm[i];
        t->model->region[i] = t->region[i];
    }
    for (uint32_t i = 0; i < 3 * s->n_triangles; i++) {
        t->model->triangles[i / 3][i % 3] = s->triangles[i / 3][i % 3];
    }
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        t->model->landmarks[i] = point_at_vertex(s, s->landmarks[i]);
    }
}

/* Progress counts five parts. */
enum { PARTS = 5 };

static int run_training(struct training *t, struct iso_fault *fault)
{
    int error = make_surfaces(t, fault);
    if (error) {
        return error;
    }
    sim_progress_step(1);
    error = allocate_arrays(t);
    if (error) {
        return iso_fault_set(fault, error, "head model: out of memory");
    }
    error = iso_head_model_new(t->coarse->n_vertices, t->coarse->n_triangles,
                               t->options->n_identity, t->options->n_expression, &t->model);
    if (error) {
        return iso_fault_set(fault, error, "head model: vertices or modes out of range");
    }
    carry_fields(t, t->ict->identity_mm, t->ict->n_identity, t->identity_mm);
    carry_fields(t, t->ict->expression_mm, t->ict->n_expression, t->expression_mm);
    draw_expressions(t);
    sim_progress_step(1);
    error = mark_regions(t);
    sim_progress_step(1);
    if (!error) {
        error = find_modes(t);
    }
    sim_progress_step(1);
    if (!error) {
        error = measure_modes(t);
    }
    sim_progress_step(1);
    if (error) {
        return iso_fault_set(fault, error, "head model: modes cannot be computed");
    }
    fill_in_mesh(t);
    return 0;
}

int sim_train_head(const struct sim_ict *ict, const struct sim_train_head_options *options,
                   struct iso_head_model **out, struct sim_train_head_report *report,
                   struct iso_fault *fault)
{
    if (ict->n_identity != SIM_IDENTITY_MODES || ict->n_expression > SIM_EXPRESSION_SHAPES_MAX ||
        options->n_identity > ict->n_identity || options->n_expression > ict->n_expression) {
        return iso_fault_set(fault, -EINVAL, "head model: too few modes to choose from");
    }
    struct training *t = calloc(1, sizeof *t);
    if (!t) {
        return iso_fault_set(fault, -ENOMEM, "head model: out of memory");
    }
    t->ict = ict;
    t->options = options;
    const bool shown = sim_progress_begin("training the head model", PARTS);
    const int error = run_training(t, fault);
    sim_progress_end(shown);
    if (error) {
        iso_head_model_free(t->model);
    } else {
        *out = t->model;
        *report = t->report;
    }
    sim_head_surface_free(t->fine);
    sim_head_surface_free(t->coarse);
    free(t->identity_mm);
    free(t->expression_mm);
    free(t->moment);
    free(t->exposure);
    free(t->expression_rms_mm);
    free(t->face_area_mm2);
    free(t->rigid_area_mm2);
    free(t->region);
    free(t);
    return error;
}
