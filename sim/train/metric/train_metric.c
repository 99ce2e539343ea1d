#include "sim/train/metric/train_metric.h"

#include <errno.h>
#include <string.h>

#include "sim/train/metric/metric_scores.h"
#include "sim/train/metric/metric_shape.h"
#include "sim/train/metric/metric_templates.h"

struct sim_train_metric_options sim_train_metric_options_default(void)
{
    return (struct sim_train_metric_options){
        .extract = iso_extract_options_default(),
        .landmarks = 1U << ISO_LM_NASION | 1U << ISO_LM_NOSE_TIP | 1U << ISO_LM_ALA_R |
                     1U << ISO_LM_ALA_L | 1U << ISO_LM_EYE_IN_R | 1U << ISO_LM_EYE_IN_L |
                     1U << ISO_LM_EYE_OUT_R | 1U << ISO_LM_EYE_OUT_L,
        .n_dimensions = 150,
        .threads = 1,
    };
}

static int learn_metric(struct sim_metric_templates *t, int threads, struct iso_metric *shape,
                        struct iso_metric **out, struct sim_train_metric_report *report,
                        struct iso_fault *fault)
{
    struct iso_metric *metric = NULL;
    report->n_frames = t->n;
    sim_metric_templates_leave_usable(t);
    sim_metric_choose_nodes(t, shape);
    int error = iso_metric_new(shape, &metric);
    if (!error) {
        error = sim_metric_learn_means(t, metric);
    }
    if (!error) {
        error = sim_metric_learn_axes(t, metric, report);
    }
    if (!error) {
        error = sim_metric_learn_scores(t, threads, metric, report);
    }
    if (error) {
        iso_metric_free(metric);
        return iso_fault_set(fault, error, "learning the metric: %s",
                             error == -ENODATA ? "too few people" : strerror(-error));
    }
    *out = metric;
    return 0;
}

int sim_train_metric(const struct sim_train_metric_options *options, struct iso_metric **out,
                     struct sim_train_metric_report *report, struct iso_fault *fault)
{
    struct sim_metric_templates t = {0};
    const struct sim_capture_options capture = {
        .model = options->model, .extract = options->extract, .threads = options->threads};
    struct sim_train_metric_report found = {0};
    struct iso_metric shape = {
        .landmarks = options->landmarks,
        .n_radii = options->extract.n_radii,
        .n_points = options->extract.n_points,
        .n_dimensions = options->n_dimensions,
        .weight_min = 0.3f,
        .gain = 1.0f,
    };
    int error = 0;
    if (options->n_corpora < 1 || options->n_corpora > SIM_METRIC_CORPORA_MAX) {
        error = iso_fault_set(fault, -EINVAL, "1..%d corpora are needed", SIM_METRIC_CORPORA_MAX);
    }
    for (int i = 0; i < options->n_corpora && !error; i++) {
        error = sim_metric_templates_read(&t, options->corpora[i], &capture, &shape, fault);
    }
    if (!error) {
        error = learn_metric(&t, options->threads, &shape, out, &found, fault);
    }
    if (!error) {
        *report = found;
    }
    sim_metric_templates_done(&t);
    return error;
}
