#include "isotherm/metric.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "core/match/metric_vector.h"
#include "core/match/upper_face.h"
#include "core/registration/rigid.h"

enum { POINTS_MAX = ISO_METRIC_VALUES_MAX / 3, PRESENT_PERCENT_MIN = 30 };

/* The points of a template that the metric uses, curve after curve. */
struct curves {
    const struct iso_metric *metric;
    const struct iso_template *tmpl;
    int n;
    uint16_t at[POINTS_MAX]; /* [n]: the index of each point among all points of a template */
};

static struct iso_vec3 vector_of(const float p[3])
{
    return iso_vec3((double)p[0], (double)p[1], (double)p[2]);
}

static double weight_of(const struct curves *curves, int k)
{
    const float *weights = (const float *)curves->tmpl->weight;
    return (double)weights[curves->at[k]];
}

static struct iso_vec3 measured_at(const struct curves *curves, int k)
{
    const float *points_mm = (const float *)curves->tmpl->points_mm;
    return vector_of(&points_mm[(size_t)3 * curves->at[k]]);
}

static struct iso_vec3 mean_at(const struct curves *curves, int k)
{
    return vector_of(&curves->metric->curve_mm[(size_t)3 * (size_t)k]);
}

static void collect_curves(const struct iso_metric *metric, const struct iso_template *t,
                           struct curves *curves)
{
    curves->metric = metric;
    curves->tmpl = t;
    curves->n = 0;
    for (int r = 0; r < t->n_radii; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            for (int i = 0; (metric->landmarks >> l & 1) && i < t->n_points; i++) {
                const int at = (r * ISO_LANDMARKS + l) * ISO_TEMPLATE_POINTS_MAX + i;
                curves->at[curves->n++] = (uint16_t)at;
            }
        }
    }
}

static bool enough_curves(const struct curves *curves)
{
    int present = 0;
    for (int k = 0; k < curves->n; k++) {
        present += weight_of(curves, k) >= (double)curves->metric->weight_min;
    }
    return present >= 3 && 100 * present >= PRESENT_PERCENT_MIN * curves->n;
}

static int fit_to_mean(const struct curves *curves, struct iso_rigid *mean_from_face)
{
    struct iso_rigid_sums sums = {.used = 0};
    for (int k = 0; k < curves->n; k++) {
        iso_rigid_sums_first(&sums, measured_at(curves, k), mean_at(curves, k),
                             weight_of(curves, k));
    }
    const int error = iso_rigid_sums_centre(&sums);
    if (error) {
        return error;
    }
    for (int k = 0; k < curves->n; k++) {
        iso_rigid_sums_second(&sums, measured_at(curves, k), mean_at(curves, k),
                              weight_of(curves, k));
    }
    *mean_from_face = iso_rigid_sums_fit(&sums);
    return 0;
}

/* Collects the curves of a template, and finds the motion that brings them closest to the mean. */
static int register_curves(const struct iso_metric *metric, const struct iso_template *tmpl,
                           struct curves *curves, struct iso_rigid *mean_from_face)
{
    if (tmpl->algorithm != metric->algorithm || tmpl->n_radii != metric->n_radii ||
        tmpl->n_points != metric->n_points) {
        return -EINVAL;
    }
    collect_curves(metric, tmpl, curves);
    return enough_curves(curves) ? fit_to_mean(curves, mean_from_face) : -ENODATA;
}

static void curve_residual(const struct curves *curves, const struct iso_rigid *mean_from_face,
                           int k, float residual_mm[3])
{
    struct iso_vec3 left = {0.0, 0.0, 0.0};
    if (weight_of(curves, k) >= (double)curves->metric->weight_min) {
        left = iso_sub(iso_rigid_apply(mean_from_face, measured_at(curves, k)), mean_at(curves, k));
    }
    residual_mm[0] = (float)left.x;
    residual_mm[1] = (float)left.y;
    residual_mm[2] = (float)left.z;
}

/* The difference between the height of a node and its mean, for the nodes that are used. */
static float height_residual(const struct iso_metric *metric, const struct iso_upper_face *face,
                             int i)
{
    const int row = iso_upper_row(metric->node[i]), column = iso_upper_column(metric->node[i]);
    const bool there = face->kind[row][column] != ISO_UPPER_NONE;
    return there ? face->z_mm[row][column] - metric->upper_mm[i] : 0.0f;
}

int iso_metric_residuals(const struct iso_metric *metric, const struct iso_template *tmpl,
                         float *residual_mm)
{
    struct curves curves;
    struct iso_rigid mean_from_face;
    const int error = register_curves(metric, tmpl, &curves, &mean_from_face);
    if (error) {
        return error;
    }
    for (int k = 0; k < curves.n; k++, residual_mm += 3) {
        curve_residual(&curves, &mean_from_face, k, residual_mm);
    }
    for (int i = 0; i < metric->n_nodes; i++) {
        residual_mm[i] = height_residual(metric, &tmpl->upper, i);
    }
    return 0;
}

double iso_metric_variance(int step)
{
    return exp2(-0.5 * step);
}

/* The squared length of a vector whose numbers are divided by their expected standard deviations,
 * for a variance within a person. *log_volume is the logarithm of the product of the expected
 * variances. */
static double length_of(const struct iso_metric *metric, const float *mean, double variance,
                        double *log_volume)
{
    double length = 0.0, volume = 1.0;
    *log_volume = 0.0;
    for (int d = 0; d < metric->n_dimensions; d++) {
        const double x = (double)mean[d], any = variance + (double)metric->between[d];
        length += x * x / any;
        volume *= any;
        if (d % 8 == 7 || d + 1 == metric->n_dimensions) { /* long before `volume` overflows */
            *log_volume += log(volume);
            volume = 1.0;
        }
    }
    return length;
}

/* The first of these alone: the same sum in the same order. */
static double squared_length(const struct iso_metric *metric, const float *mean, double variance)
{
    double length = 0.0;
    for (int d = 0; d < metric->n_dimensions; d++) {
        const double x = (double)mean[d];
        length += x * x / (variance + (double)metric->between[d]);
    }
    return length;
}

static int step_of(float weight)
{
    const long step = lrint(2.0 * log2((double)weight));
    if (step < ISO_METRIC_STEP_MIN) {
        return ISO_METRIC_STEP_MIN;
    }
    return step > ISO_METRIC_STEP_MAX ? ISO_METRIC_STEP_MAX : (int)step;
}

/* The factor that gives a vector the expected length of a vector of its weight. Templates that are
 * unlike the people of the training (another sensor, a bad fit) have long vectors, and this length
 * does not depend on the person. Real errors have heavier tails than the model (length
 * normalisation: Garcia-Romero and Espy-Wilson 2011). Equal error rate on real frames: 1.4 % with
 * the factor, 2.3 % without; 2.6 % with it if all templates are taken to be equally noisy. */
static float normal_scale(const struct iso_metric *metric, const struct iso_metric_vector *vector)
{
    double log_volume;
    const double variance = iso_metric_variance(vector->step);
    const double length = length_of(metric, vector->mean, variance, &log_volume);
    return (float)sqrt(metric->n_dimensions / fmax(length, 1e-9));
}

static void set_step(const struct iso_metric *metric, int step, struct iso_metric_vector *vector)
{
    vector->step = step;
    vector->weight = (float)(1.0 / iso_metric_variance(step));
    vector->scale = normal_scale(metric, vector);
}

/* Sets the step of the most likely variance within a person. `unlikeliness` is, for each step of
 * one template, minus twice the logarithm of the likelihood, up to a constant. */
static void set_likeliest_step(const struct iso_metric *metric,
                               const double unlikeliness[ISO_METRIC_STEPS_ONE],
                               struct iso_metric_vector *vector)
{
    int best = 0;
    for (int s = 1; s < ISO_METRIC_STEPS_ONE; s++) {
        best = unlikeliness[s] < unlikeliness[best] ? s : best;
    }
    set_step(metric, best + ISO_METRIC_STEP_MIN, vector);
}

/* `steps` may be NULL; if they are known, no logarithms are needed. */
static void judge_vector(const struct iso_metric *metric, const struct iso_metric_steps *steps,
                         struct iso_metric_vector *vector)
{
    double unlikeliness[ISO_METRIC_STEPS_ONE], log_volume;
    for (int s = 0; s < ISO_METRIC_STEPS_ONE; s++) {
        const double variance = iso_metric_variance(s + ISO_METRIC_STEP_MIN);
        if (steps) {
            unlikeliness[s] = squared_length(metric, vector->mean, variance) + steps->log_volume[s];
        } else {
            const double length = length_of(metric, vector->mean, variance, &log_volume);
            unlikeliness[s] = length + log_volume;
        }
    }
    set_likeliest_step(metric, unlikeliness, vector);
}

void iso_metric_steps_fill(const struct iso_metric *metric, struct iso_metric_steps *steps)
{
    static const float nothing[ISO_METRIC_DIMENSIONS_MAX];
    for (int s = 0; s < ISO_METRIC_STEPS_ONE; s++) {
        const double variance = iso_metric_variance(s + ISO_METRIC_STEP_MIN);
        (void)length_of(metric, nothing, variance, &steps->log_volume[s]);
        for (int d = 0; d < metric->n_dimensions; d++) {
            steps->inverse[d][s] = 1.0 / (variance + (double)metric->between[d]);
        }
    }
}

void iso_metric_vector_judge(const struct iso_metric *metric, const struct iso_metric_steps *steps,
                             struct iso_metric_vector *vector)
{
    double unlikeliness[ISO_METRIC_STEPS_ONE];
    memcpy(unlikeliness, steps->log_volume, sizeof unlikeliness);
    for (int d = 0; d < metric->n_dimensions; d++) {
        const double square = (double)vector->mean[d] * (double)vector->mean[d];
        for (int s = 0; s < ISO_METRIC_STEPS_ONE; s++) {
            unlikeliness[s] += square * steps->inverse[d][s];
        }
    }
    set_likeliest_step(metric, unlikeliness, vector);
}

/* Adds the contribution of one residual: its value times its row of the projection. */
static void project_value(const struct iso_metric *metric, int v, float residual_mm,
                          struct iso_metric_vector *out)
{
    const float *axis = &metric->axis[(size_t)v * (size_t)metric->n_dimensions];
    for (int d = 0; d < metric->n_dimensions; d++) {
        out->mean[d] += residual_mm * axis[d];
    }
}

/* Galleries store these vectors. Where they change for the same metric,
 * test_firmware_gallery_vectors fails and says what else has to change. */
int iso_metric_project(const struct iso_metric *metric, const struct iso_template *tmpl,
                       struct iso_metric_vector *out)
{
    struct curves curves;
    struct iso_rigid mean_from_face;
    const int error = register_curves(metric, tmpl, &curves, &mean_from_face);
    if (error) {
        return error;
    }
    *out = (struct iso_metric_vector){.n = 1};
    for (int d = 0; d < metric->n_dimensions; d++) {
        out->mean[d] = -metric->centre[d];
    }
    float residual_mm[3];
    for (int k = 0; k < curves.n; k++) {
        curve_residual(&curves, &mean_from_face, k, residual_mm);
        for (int c = 0; c < 3; c++) {
            project_value(metric, 3 * k + c, residual_mm[c], out);
        }
    }
    for (int i = 0; i < metric->n_nodes; i++) {
        project_value(metric, 3 * curves.n + i, height_residual(metric, &tmpl->upper, i), out);
    }
    judge_vector(metric, NULL, out);
    explicit_bzero(residual_mm, sizeof residual_mm);
    return 0;
}

static iso_project_function *project_here(void)
{
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        return iso__project_avx2;
    }
#endif
    return iso__project_baseline;
}

void iso_metric_project_rows(const struct iso_metric *metric, const struct iso_metric_steps *steps,
                             const float *residual_mm, int n, struct iso_metric_vector *out)
{
    float mean[ISO_METRIC_ROWS][ISO_METRIC_DIMENSIONS_MAX];
    project_here()(metric, residual_mm, n, mean);
    for (int i = 0; i < n; i++) {
        out[i] = (struct iso_metric_vector){.n = 1};
        memcpy(out[i].mean, mean[i], (size_t)metric->n_dimensions * sizeof mean[i][0]);
        judge_vector(metric, steps, &out[i]);
    }
    explicit_bzero(mean, sizeof mean);
}

void iso_metric_vector_add(const struct iso_metric *metric, const struct iso_metric_vector *one,
                           struct iso_metric_vector *all)
{
    if (one->n < 1) {
        return;
    }
    const float before = all->n > 0 ? all->weight : 0.0f, weight = before + one->weight;
    for (int d = 0; d < metric->n_dimensions; d++) {
        const float sum = before > 0.0f ? before * all->mean[d] : 0.0f;
        all->mean[d] = (sum + one->weight * one->mean[d]) / weight;
    }
    all->n = (all->n > 0 ? all->n : 0) + one->n;
    all->weight = weight;
    all->step = step_of(weight);
    all->scale = normal_scale(metric, all);
}

/* Let b be the variance between people, m the mean of the person's templates, and v its variance
 * within the person. The true mean of the person then has the distribution
 * N(b m / (b + v), b v / (b + v)). A probe of the person varies about the true mean by the variance
 * `own` of the probe. A probe of anybody has the distribution N(0, own + b). */
double iso_metric_score(const struct iso_metric *metric, const struct iso_metric_vector *person,
                        const struct iso_metric_vector *probe)
{
    if (person->n < 1 || probe->n < 1) {
        return -INFINITY;
    }
    const double v = iso_metric_variance(person->step), own = iso_metric_variance(probe->step);
    double ratio = 0.0;
    for (int d = 0; d < metric->n_dimensions; d++) {
        const double b = (double)metric->between[d], x = (double)(probe->scale * probe->mean[d]);
        const double shrink = b / (b + v), same = own + b * v / (b + v), any = own + b;
        const double off = x - shrink * (double)(person->scale * person->mean[d]);
        ratio += x * x / any - off * off / same + log(any / same);
    }
    return (double)metric->gain * 0.5 * ratio + (double)metric->bias;
}
