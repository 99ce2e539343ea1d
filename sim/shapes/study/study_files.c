#include "drivers/base/path.h"
#include "sim/base/result_file.h"
#include "sim/lab/draw/plot.h"
#include "sim/shapes/study/sheet.h"
#include "sim/shapes/study/study_data.h"

static void write_measures(const void *context, FILE *out)
{
    const struct sim_study *study = context;
    fputs("method,classifier,queries,nn,first_tier,second_tier,e_measure,dcg,adr,"
          "tp_rate,fp_rate,precision,recall,roc_area,describe_s,eigenpairs_s\n",
          out);
    for (int i = 0; i < study->n_results; i++) {
        const struct sim_study_result *r = &study->result[i];
        const struct iso_retrieval *m = &r->retrieval;
        int method = 0;
        while (study->choice.method[method] != r->method) {
            method++;
        }
        fprintf(out, "%s,%s,", r->method->name, r->classifier->name);
        if (r->ranked) {
            fprintf(out, "%d,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f", m->n_queries, m->nearest,
                    m->first_tier, m->second_tier, m->e_measure, m->dcg, m->adr);
        } else {
            fputs(",,,,,,", out);
        }
        fprintf(out, ",%.6f,%.6f,%.6f,%.6f,%.6f,%.3f,%.3f\n", r->rates.tp_rate, r->rates.fp_rate,
                r->rates.precision, r->rates.recall, r->rates.roc_area,
                study->items->seconds[method], study->items->shape_seconds);
    }
}

enum { CURVES_MAX = 12 };

/* Draws the curves from the result `from` on, at most CURVES_MAX. *next is the first result that is
 * not drawn. */
static int plot_some(const struct sim_study *study, int from, const char *path, int *next,
                     struct iso_fault *fault)
{
    char label[CURVES_MAX][64];
    double recall[ISO_RECALL_LEVELS];
    struct sim_series series[CURVES_MAX];
    size_t n = 0;
    int i = from;
    for (int level = 0; level < ISO_RECALL_LEVELS; level++) {
        recall[level] = (level + 1.0) / ISO_RECALL_LEVELS;
    }
    for (; i < study->n_results && n < CURVES_MAX; i++) {
        const struct sim_study_result *r = &study->result[i];
        if (r->ranked) {
            (void)snprintf(label[n], sizeof label[n], "%s, %s", r->method->title,
                           r->classifier->title);
            series[n] = (struct sim_series){label[n], SIM_SERIES_LINE, ISO_RECALL_LEVELS, recall,
                                            r->retrieval.precision};
            n++;
        }
    }
    *next = i;
    const struct sim_plot plot = {
        .title = "Precision and recall",
        .legend = SIM_LEGEND_LOWER,
        .x = {"recall", SIM_SCALE_LINEAR, 0.0, 1.0},
        .y = {"precision", SIM_SCALE_LINEAR, 0.0, 1.0},
        .n_series = n,
        .series = series,
    };
    return n == 0 ? 0 : sim_plot_write(&plot, path, fault);
}

static int plot_curves(const struct sim_study *study, struct iso_fault *fault)
{
    char name[64] = "precision-recall.png", path[PATH_MAX];
    int error = 0;
    for (int next = 0, number = 2; next < study->n_results && !error; number++) {
        error = iso_path_join(study->options->out, name, path, fault);
        if (!error) {
            error = plot_some(study, next, path, &next, fault);
        }
        (void)snprintf(name, sizeof name, "precision-recall-%d.png", number);
    }
    return error;
}

int sim_study_save(const struct sim_study *study, struct iso_fault *fault)
{
    char path[PATH_MAX];
    int error = sim_result_file(study->options->out, "measures.csv", write_measures, study, fault);
    if (!error) {
        error = sim_study_save_parameters(study, fault);
    }
    if (!error) {
        error = plot_curves(study, fault);
    }
    if (!error && study->options->pictures > 0) {
        error = iso_path_join(study->options->out, "shapes.png", path, fault);
        if (!error) {
            error = sim_sheet_classes(&study->items_how, study->options->pictures + 1, path, fault);
        }
    }
    return error;
}
