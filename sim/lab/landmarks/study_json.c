#include <stdio.h>

#include "drivers/base/path.h"
#include "sim/lab/landmarks/study.h"
#include "sim/lab/report/json.h"

static json_t *reasons_json(const size_t reason[SIM_REASONS])
{
    json_t *object = json_object();
    for (int r = 0; r < SIM_REASONS; r++) {
        if (reason[r] > 0) {
            json_object_set_new(object, sim_reason_name(r), json_integer((json_int_t)reason[r]));
        }
    }
    return object;
}

static json_t *failures_json(const struct sim_failures failures[SIM_FAILURE_RULES])
{
    json_t *object = json_pack("{s:f}", "limit_mm", SIM_FAILURE_MM);
    static const char *const names[SIM_FAILURE_RULES] = {"mean", "centred_mean", "centred_max"};
    for (int r = 0; r < SIM_FAILURE_RULES; r++) {
        json_object_set_new(object, names[r],
                            json_pack("{s:o, s:o, s:o}", "before_gates",
                                      sim_json_exact_rate(failures[r].before), "after_gates",
                                      sim_json_exact_rate(failures[r].after), "good_refused",
                                      sim_json_exact_rate(failures[r].good_refused)));
    }
    return object;
}

static json_t *condition_json(const struct sim_condition_figures *c)
{
    json_t *object = json_pack("{s:o, s:I, s:f, s:f, s:f, s:f, s:f, s:o}", "refused",
                               sim_json_exact_rate(c->refused), "errors", (json_int_t)c->error_mm.n,
                               "mean_mm", c->error_mm.mean, "p95_mm", c->error_mm.p95,
                               "centred_mean_mm", c->centred_error_mm.mean, "centred_median_mm",
                               c->centred_error_mm.median, "centred_p95_mm",
                               c->centred_error_mm.p95, "failures", failures_json(c->failures));
    if (c->column) {
        json_object_set_new(object, "column", json_string(c->column));
        json_object_set_new(object, "value", json_string(c->value));
    }
    return object;
}

static json_t *conditions_json(const struct sim_landmark_analysis *a)
{
    json_t *array = json_array();
    for (size_t i = 0; i < a->n_conditions; i++) {
        json_array_append_new(array, condition_json(&a->conditions[i]));
    }
    return array;
}

static json_t *kinds_json(const struct sim_landmark_analysis *a, enum sim_row_kind kind)
{
    json_t *object = json_object();
    for (size_t i = 0; i < a->n_kinds; i++) {
        const struct sim_kind_figures *k = &a->kinds[i];
        if (k->kind != kind) {
            continue;
        }
        json_t *figures = json_pack("{s:o, s:o}", "frames_accepted",
                                    sim_json_exact_rate(k->accepted_frames), "outcomes",
                                    reasons_json(k->reason));
        if (kind == SIM_ROW_ATTACK) {
            json_object_set_new(figures, "apcer",
                                sim_json_exact_rate(k->response[SIM_RESPONSE_BONA_FIDE]));
            json_object_set_new(figures, "apnrr",
                                sim_json_exact_rate(k->response[SIM_RESPONSE_NONE]));
        }
        json_object_set_new(object, k->note, figures);
    }
    return object;
}

static json_t *times_json(const struct sim_landmark_analysis *a)
{
    json_t *object = json_object();
    for (int s = 0; s < ISO_STAGES; s++) {
        json_object_set_new(object, iso_stage_name((enum iso_stage)s),
                            sim_json_latency(a->stage[s]));
    }
    json_object_set_new(object, "frame", sim_json_latency(a->whole));
    return object;
}

static json_t *settings_json(const struct sim_study *study)
{
    char algorithm[16];
    (void)snprintf(algorithm, sizeof algorithm, "%08x",
                   (unsigned)study->measurement->origin.algorithm);
    return json_pack("{s:s, s:s, s:o}", "algorithm", algorithm, "sensor",
                     study->measurement->origin.sensor, "extract",
                     sim_json_extract(&study->options.extract));
}

int sim_study_json(const struct sim_study *study, const char *directory, struct iso_fault *fault)
{
    const struct sim_landmark_analysis *a = study->analysis;
    char path[PATH_MAX];
    const int error = iso_path_join(directory, "summary.json", path, fault);
    if (error) {
        return error;
    }
    json_t *bona_fide = json_pack(
        "{s:o, s:o, s:o}", "bpcer", sim_json_exact_rate(a->bona_fide[SIM_RESPONSE_ATTACK]), "bpnrr",
        sim_json_exact_rate(a->bona_fide[SIM_RESPONSE_NONE]), "outcomes", reasons_json(a->reason));
    json_t *frames = json_pack("{s:I, s:I, s:I}", "all", (json_int_t)study->measurement->n_frames,
                               "bona_fide", (json_int_t)a->n_bona_fide, "with_truth_and_fit",
                               (json_int_t)a->n_true);
    json_t *summary = json_pack(
        "{s:i, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "format", 1, "corpus",
        study->options.corpus, "settings", settings_json(study), "frames", frames, "landmarks",
        sim_json_landmarks(a->after), "landmarks_before_gates", sim_json_landmarks(a->before),
        "all", condition_json(&a->all), "conditions", conditions_json(a), "not_faces",
        kinds_json(a, SIM_ROW_NOT_A_FACE), "attacks", kinds_json(a, SIM_ROW_ATTACK), "bona_fide",
        bona_fide, "latency_ms", times_json(a));
    return sim_json_file(summary, path, fault);
}
