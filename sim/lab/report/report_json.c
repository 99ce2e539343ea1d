#include "drivers/base/path.h"
#include "sim/lab/measure/promise.h"
#include "sim/lab/report/json.h"
#include "sim/lab/report/report.h"
#include "sim/lab/report/report_calibration.h"

static json_t *settings_json(const struct sim_eval *eval)
{
    static const char *const scores[] = {
        [SIM_SCORE_PAIRWISE] = "negative distance",
        [SIM_SCORE_METRIC] = "metric",
        [SIM_SCORE_COHORT] = "cohort-normalised",
        [SIM_SCORE_DISTANCE] = "negative distance, mm",
    };
    const struct sim_eval_options *o = &eval->options;
    char algorithm[16];
    (void)snprintf(algorithm, sizeof algorithm, "%08x",
                   (unsigned)eval->acquisition->origin.algorithm);
    json_t *match = json_pack("{s:f, s:i, s:s}", "trim", o->match.trim, "icp_iterations",
                              o->match.icp_iterations, "transform",
                              o->match.transform == ISO_ICP_AFFINE ? "affine" : "rigid");
    return json_pack(
        "{s:s, s:s, s:s, s:I, s:I, s:I, s:I, s:s, s:o, s:o}", "method", sim_eval_first(eval)->name,
        "algorithm", algorithm, "score", scores[sim_eval_score_kind(eval)], "fuse",
        (json_int_t)o->fuse, "gallery_frames", (json_int_t)o->gallery_frames, "probe_frames",
        (json_int_t)o->probe_frames, "gallery_limit", (json_int_t)o->gallery_limit, "sensor",
        eval->acquisition->origin.sensor, "extract", sim_json_extract(&o->extract), "match", match);
}

static json_t *reasons_json(const size_t reason[SIM_REASONS])
{
    json_t *object = json_object();
    for (int r = 0; r < SIM_REASONS; r++) {
        if (r != ISO_CAPTURE_OK && reason[r] > 0) {
            json_object_set_new(object, sim_reason_name(r), json_integer((json_int_t)reason[r]));
        }
    }
    return object;
}

static json_t *acquisition_json(const struct sim_eval *eval)
{
    const struct sim_analysis *a = eval->analysis;
    const size_t(*probe)[SIM_REASONS] = a->probe_reason;
    const size_t n_faces = a->n_kind[SIM_PROBE_MATED] + a->n_kind[SIM_PROBE_STRANGER];
    const size_t acquired = probe[SIM_PROBE_MATED][ISO_CAPTURE_OK] +
                            probe[SIM_PROBE_STRANGER][ISO_CAPTURE_OK];
    struct sim_rate enrol = {a->n_people_not_enrolled, eval->gallery->n_people};
    struct sim_rate acquire = {n_faces - acquired, n_faces};
    return json_pack("{s:I, s:I, s:o, s:o, s:{s:o, s:o, s:o, s:o}}", "frames",
                     (json_int_t)eval->acquisition->n_captures, "frames_usable",
                     (json_int_t)a->n_usable_captures, "failure_to_enrol", sim_json_rate(enrol),
                     "failure_to_acquire", sim_json_rate(acquire), "reasons", "gallery",
                     reasons_json(a->gallery_reason), "enrolled",
                     reasons_json(probe[SIM_PROBE_MATED]), "strangers",
                     reasons_json(probe[SIM_PROBE_STRANGER]), "not_faces",
                     reasons_json(probe[SIM_PROBE_NONE]));
}

static json_t *promises_json(const struct sim_scores *scores)
{
    struct sim_promise promises[SIM_PROMISES];
    json_t *array = json_array();
    sim_promises_of(scores, promises);
    for (int i = 0; i < SIM_PROMISES; i++) {
        json_array_append_new(array, json_pack("{s:f, s:o, s:o}", "score", promises[i].score, "fmr",
                                               sim_json_rate(promises[i].false_match), "fnmr",
                                               sim_json_rate(promises[i].non_match)));
    }
    return array;
}

static json_t *verification_json(const struct sim_verification *v)
{
    json_t *object = json_pack("{s:I, s:I, s:I, s:f}", "mated", (json_int_t)v->scores.n_mated,
                               "non_mated", (json_int_t)v->scores.n_non_mated, "mated_lost",
                               (json_int_t)v->n_lost, "smallest_fmr_supported",
                               sim_rate_smallest(v->scores.n_non_mated));
    if (v->n_det == 0) {
        return object;
    }
    json_object_set_new(object, "eer",
                        json_pack("{s:f, s:f, s:f}", "rate", v->eer, "low", v->eer_interval.low,
                                  "high", v->eer_interval.high));
    json_t *points = json_array();
    for (int k = 0; k < SIM_FMR_TARGETS; k++) {
        const struct sim_operating_point *p = &v->at_fmr[k];
        json_array_append_new(points, json_pack("{s:f, s:b, s:o, s:f, s:f, s:f, s:f, s:o}", "fmr",
                                                sim_fmr_targets[k], "supported", (int)p->supported,
                                                "threshold", sim_json_number(p->at.threshold),
                                                "fmr_observed", p->at.fmr, "fnmr", p->at.fnmr,
                                                "low", p->fnmr.low, "high", p->fnmr.high, "gfnmr",
                                                sim_json_rate(p->gfnmr)));
    }
    json_object_set_new(object, "fnmr_at_fmr", points);
    return object;
}

static json_t *identification_json(const struct sim_eval *eval)
{
    const struct sim_identification *id = &eval->analysis->identification;
    json_t *object = json_pack(
        "{s:I, s:I, s:I, s:I}", "people", (json_int_t)eval->gallery->n_people, "templates",
        (json_int_t)eval->gallery->n_templates, "searches", (json_int_t)id->n_searches, "strangers",
        (json_int_t)id->n_strangers);
    if (id->n_searches == 0) {
        return object;
    }
    json_object_set_new(object, "rank_1",
                        sim_json_rate(sim_rank_rate(id->searches, id->n_searches, 1)));
    json_object_set_new(object, "rank_4",
                        sim_json_rate(sim_rank_rate(id->searches, id->n_searches, 4)));
    if (id->n_strangers == 0) {
        return object;
    }
    json_object_set_new(object, "smallest_fpir_supported",
                        json_real(sim_rate_smallest(id->n_strangers)));
    json_t *points = json_array();
    for (int k = 0; k < SIM_FPIR_TARGETS; k++) {
        const struct sim_open_set_point *p = &id->at_fpir[k];
        json_array_append_new(points,
                              json_pack("{s:f, s:o, s:o, s:o}", "fpir", sim_fpir_targets[k],
                                        "threshold", sim_json_number(p->threshold), "fpir_observed",
                                        sim_json_rate(p->fpir), "fnir", sim_json_rate(p->fnir)));
    }
    json_object_set_new(object, "fnir_at_fpir", points);
    return object;
}

static json_t *growth_json(const struct sim_growth *growth)
{
    json_t *array = json_array();
    for (size_t i = 0; i < growth->n; i++) {
        const struct sim_growth_point *p = &growth->points[i];
        json_array_append_new(array, json_pack("{s:I, s:f, s:f, s:f}", "people",
                                               (json_int_t)p->n_people, "fpir", p->fpir, "fnir",
                                               p->fnir, "fnir_at_fpir", p->fnir_at_fpir));
    }
    return array;
}

static json_t *conditions_json(const struct sim_analysis *a)
{
    json_t *array = json_array();
    for (size_t i = 0; i < a->n_conditions; i++) {
        const struct sim_condition *c = &a->conditions[i];
        json_array_append_new(
            array, json_pack("{s:s, s:s, s:o, s:o, s:o, s:o}", "column", c->column, "value",
                             c->value, "failure_to_acquire", sim_json_rate(c->not_acquired),
                             "rank_1", sim_json_rate(c->rank_1), "rank_4", sim_json_rate(c->rank_4),
                             "eer", sim_json_number(c->eer)));
    }
    return array;
}

static json_t *latencies_json(const struct sim_analysis *a)
{
    json_t *stages = json_object();
    for (int s = 0; s < ISO_STAGES; s++) {
        json_object_set_new(stages, iso_stage_name((enum iso_stage)s),
                            sim_json_latency(a->stage[s]));
    }
    return json_pack("{s:o, s:{s:o, s:o}, s:{s:o, s:o}}", "stages_cpu", stages, "template", "cpu",
                     sim_json_latency(a->extract_cpu), "wall", sim_json_latency(a->extract_wall),
                     "search", "cpu", sim_json_latency(a->search_cpu), "wall",
                     sim_json_latency(a->search_wall));
}

int sim_report_json(const struct sim_eval *eval, const char *directory, struct iso_fault *fault)
{
    const struct sim_analysis *a = eval->analysis;
    char path[PATH_MAX];
    const int error = iso_path_join(directory, "summary.json", path, fault);
    if (error) {
        return error;
    }
    json_t *summary = json_pack(
        "{s:i, s:s, s:o, s:o, s:o, s:o, s:{s:I, s:I, s:I}, s:o, s:o, s:o, s:o}", "format", 1,
        "corpus", eval->options.corpus, "settings", settings_json(eval), "acquisition",
        acquisition_json(eval), "verification", verification_json(&a->verification),
        "identification", identification_json(eval), "not_faces", "samples",
        (json_int_t)a->n_kind[SIM_PROBE_NONE], "accepted",
        (json_int_t)a->probe_reason[SIM_PROBE_NONE][ISO_CAPTURE_OK], "matched",
        (json_int_t)a->none_matched, "growth", growth_json(&eval->growth), "conditions",
        conditions_json(a), "landmarks", sim_json_landmarks(eval->landmarks), "latency_ms",
        latencies_json(a));
    if (summary && sim_eval_score_kind(eval) == SIM_SCORE_METRIC) {
        json_object_set_new(summary, "calibration", promises_json(&a->verification.scores));
    }
    if (summary && eval->calibration.known) {
        json_object_set_new(summary, "promise", sim_json_calibration(&eval->calibration));
    }
    if (summary && eval->metric) {
        json_object_set_new(summary, "site", sim_json_site(eval));
    }
    return sim_json_file(summary, path, fault);
}
