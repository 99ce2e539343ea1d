#include "sim/train/metric/metric_shape.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/match/upper_face.h"
#include "sim/base/progress.h"
#include "sim/train/metric/metric_learn.h"

enum { REGISTRATIONS = 3 };

/* Adds a template's points to the sums of the curves, and counts them after the sums. It takes
 * the points as they are or, if there are residuals, their registered positions. */
static void add_curves(const struct iso_metric *metric, const struct iso_template *tmpl,
                       const float *residual_mm, double *sum)
{
    const size_t width = (size_t)metric->n_curve_values;
    size_t v = 0;
    for (int r = 0; r < metric->n_radii; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            for (int i = 0; (metric->landmarks >> l & 1) && i < metric->n_points; i++) {
                const bool seen = tmpl->weight[r][l][i] >= metric->weight_min;
                const float *p = tmpl->points_mm[r][l][i];
                for (int k = 0; k < 3 && seen; k++) {
                    const float mm = residual_mm ? metric->curve_mm[v + (size_t)k] +
                                                       residual_mm[v + (size_t)k]
                                                 : p[k];
                    sum[v + (size_t)k] += (double)mm;
                    sum[width + v + (size_t)k] += 1.0;
                }
                v += 3;
            }
        }
    }
}

/* The mean curves: first the mean in the face frame, then the mean of the curves registered to
 * it. */
static int learn_curves(const struct sim_metric_templates *t, struct iso_metric *metric)
{
    const size_t width = (size_t)metric->n_curve_values;
    float *residual_mm = calloc((size_t)metric->n_values, sizeof *residual_mm);
    double *sum = calloc(2 * width, sizeof *sum);
    const int error = residual_mm && sum ? 0 : -ENOMEM;
    const bool shown = sim_progress_begin("averaging the curves", (REGISTRATIONS + 1) * t->n);
    for (int pass = 0; pass <= REGISTRATIONS && !error; pass++) {
        memset(sum, 0, 2 * width * sizeof *sum);
        for (size_t s = 0; s < t->n; s++) {
            sim_progress_step(1);
            if (sim_metric_is_held_out(t->person[s]) ||
                (pass > 0 && iso_metric_residuals(metric, &t->tmpl[s], residual_mm))) {
                continue;
            }
            add_curves(metric, &t->tmpl[s], pass > 0 ? residual_mm : NULL, sum);
        }
        for (size_t v = 0; v < width; v++) {
            metric->curve_mm[v] = (float)(sum[v] / fmax(sum[width + v], 1.0));
        }
    }
    sim_progress_end(shown);
    free(residual_mm);
    free(sum);
    return error;
}

void sim_metric_choose_nodes(const struct sim_metric_templates *t, struct iso_metric *shape)
{
    enum { MISSING_PERMILLE = 5 };
    for (int i = 0; i < ISO_UPPER_NODES; i++) {
        const int row = iso_upper_row(i), column = iso_upper_column(i);
        size_t missing = 0, n = 0;
        for (size_t s = 0; s < t->n; s++) {
            if (!sim_metric_is_held_out(t->person[s])) {
                missing += t->tmpl[s].upper.kind[row][column] == ISO_UPPER_NONE;
                n++;
            }
        }
        if ((row + column) % 2 == 0 && 1000 * missing <= MISSING_PERMILLE * n) {
            shape->node[shape->n_nodes++] = (uint16_t)i;
        }
    }
}

/* The mean heights of the upper face, over the templates that have one. As everywhere in this file,
 * the people who calibrate the scores take no part. */
static void learn_heights(const struct sim_metric_templates *t, struct iso_metric *metric)
{
    for (int i = 0; i < metric->n_nodes; i++) {
        const int row = iso_upper_row(metric->node[i]);
        const int column = iso_upper_column(metric->node[i]);
        double sum_mm = 0.0;
        size_t n = 0;
        for (size_t s = 0; s < t->n; s++) {
            if (!sim_metric_is_held_out(t->person[s]) &&
                t->tmpl[s].upper.kind[row][column] != ISO_UPPER_NONE) {
                sum_mm += (double)t->tmpl[s].upper.z_mm[row][column];
                n++;
            }
        }
        metric->upper_mm[i] = (float)(sum_mm / fmax((double)n, 1.0));
    }
}

/* Numbers the people for the learning again, without the people held out. */
int sim_metric_learn_axes(const struct sim_metric_templates *t, struct iso_metric *metric,
                          struct sim_train_metric_report *report)
{
    const size_t width = (size_t)metric->n_values;
    float *residual_mm = calloc(t->n * width + 1, sizeof *residual_mm);
    size_t *person = calloc(t->n + 1, sizeof *person);
    size_t *number = calloc(t->n_people + 1, sizeof *number); /* 0: no template of the person yet */
    int error = residual_mm && person && number ? 0 : -ENOMEM;
    struct sim_metric_samples samples = {0};
    const bool shown = sim_progress_begin("registering the templates", t->n);
    for (size_t s = 0; !error && s < t->n; s++) {
        const size_t who = t->person[s];
        sim_progress_step(1);
        if (sim_metric_is_held_out(who) ||
            iso_metric_residuals(metric, &t->tmpl[s], &residual_mm[samples.n * width])) {
            continue;
        }
        if (number[who] == 0) {
            number[who] = ++samples.n_people;
        }
        person[samples.n++] = number[who] - 1;
    }
    sim_progress_end(shown);
    if (!error) {
        samples.residual_mm = residual_mm;
        samples.person = person;
        error = sim_metric_learn(&samples, metric, &report->explained);
        report->n_people = samples.n_people;
        report->n_templates = samples.n;
    }
    free(residual_mm);
    free(person);
    free(number);
    return error;
}

int sim_metric_learn_means(const struct sim_metric_templates *t, struct iso_metric *metric)
{
    const int error = learn_curves(t, metric);
    if (error) {
        return error;
    }
    learn_heights(t, metric);
    return 0;
}
