#include <errno.h>
#include <jansson.h>
#include <math.h>

#include "sim/eval/report.h"

/* Out of memory shows as a NULL that Jansson's setters refuse; json_dump_file then fails. */

/* JSON has no infinities and no NaN: null. */
static json_t *number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *rate_json(struct sim_rate rate)
{
    struct sim_interval interval = sim_rate_interval(rate);
    return json_pack("{s:o, s:f, s:f, s:I, s:I}", "rate", number(sim_rate_value(rate)), "low",
                     interval.low, "high", interval.high, "events", (json_int_t)rate.events,
                     "trials", (json_int_t)rate.trials);
}

static json_t *extract_json(const struct iso_extract_options *x)
{
    json_t *radii = json_array();
    for (int r = 0; r < x->n_radii; r++) {
        json_array_append_new(radii, number(x->radius_mm[r]));
    }
    json_t *fit = json_pack("{s:i, s:i, s:f, s:f, s:f, s:f, s:f}", "rigid_iterations",
                            x->fit.rigid_iterations, "iterations", x->fit.iterations,
                            "cutoff_first_mm", x->fit.cutoff_first_mm, "cutoff_last_mm",
                            x->fit.cutoff_last_mm, "soft_weight", x->fit.soft_weight,
                            "identity_stiffness_mm2", x->fit.identity_stiffness_mm2,
                            "expression_stiffness_mm2", x->fit.expression_stiffness_mm2);
    return json_pack("{s:s, s:f, s:o, s:i, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:o}", "heat",
                     x->heat == ISO_HEAT_SPECTRAL ? "spectral" : "direct", "t_mm2", x->t_mm2,
                     "radii_mm", radii, "points", x->n_points, "crop_radius_mm", x->crop_radius_mm,
                     "spacing_mm", x->spacing_mm, "smoothing_mm", x->smoothing_mm, "outlier_mm",
                     x->outlier_mm, "distance_min_mm", x->distance_min_mm, "distance_max_mm",
                     x->distance_max_mm, "yaw_max_rad", x->yaw_max_rad, "pitch_max_rad",
                     x->pitch_max_rad, "fit", fit);
}

static json_t *settings_json(const struct sim_eval *eval)
{
    const struct sim_eval_options *o = &eval->options;
    char algorithm[16];
    (void)snprintf(algorithm, sizeof algorithm, "%08x", (unsigned)eval->acquisition->algorithm);
    json_t *match = json_pack("{s:f, s:i, s:s}", "trim", o->match.trim, "icp_iterations",
                              o->match.icp_iterations, "transform",
                              o->match.transform == ISO_ICP_AFFINE ? "affine" : "rigid");
    return json_pack(
        "{s:s, s:s, s:s, s:I, s:I, s:s, s:o, s:o}", "method", "hfpc", "algorithm", algorithm,
        "score", eval->cohort ? "cohort-normalised" : "negative distance, mm", "fuse",
        (json_int_t)o->fuse, "gallery_limit", (json_int_t)o->gallery_limit, "sensor",
        eval->acquisition->sensor, "extract", extract_json(&o->extract), "match", match);
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
    size_t n_faces = a->n_kind[SIM_PROBE_MATED] + a->n_kind[SIM_PROBE_STRANGER];
    size_t acquired = probe[SIM_PROBE_MATED][ISO_CAPTURE_OK] +
                      probe[SIM_PROBE_STRANGER][ISO_CAPTURE_OK];
    struct sim_rate enrol = {a->n_people_not_enrolled, eval->gallery->n_people};
    struct sim_rate acquire = {n_faces - acquired, n_faces};
    return json_pack("{s:I, s:I, s:o, s:o, s:{s:o, s:o, s:o, s:o}}", "frames",
                     (json_int_t)eval->acquisition->n_captures, "frames_usable",
                     (json_int_t)a->n_usable_captures, "failure_to_enrol", rate_json(enrol),
                     "failure_to_acquire", rate_json(acquire), "reasons", "gallery",
                     reasons_json(a->gallery_reason), "enrolled",
                     reasons_json(probe[SIM_PROBE_MATED]), "strangers",
                     reasons_json(probe[SIM_PROBE_STRANGER]), "not_faces",
                     reasons_json(probe[SIM_PROBE_NONE]));
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
        json_array_append_new(
            points, json_pack("{s:f, s:b, s:o, s:f, s:f, s:f, s:f, s:o}", "fmr", sim_fmr_targets[k],
                              "supported", (int)p->supported, "threshold", number(p->at.threshold),
                              "fmr_observed", p->at.fmr, "fnmr", p->at.fnmr, "low", p->fnmr.low,
                              "high", p->fnmr.high, "gfnmr", rate_json(p->gfnmr)));
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
                        rate_json(sim_rank_rate(id->searches, id->n_searches, 1)));
    json_object_set_new(object, "rank_4",
                        rate_json(sim_rank_rate(id->searches, id->n_searches, 4)));
    if (id->n_strangers == 0) {
        return object;
    }
    json_object_set_new(object, "smallest_fpir_supported",
                        json_real(sim_rate_smallest(id->n_strangers)));
    json_t *points = json_array();
    for (int k = 0; k < SIM_FPIR_TARGETS; k++) {
        const struct sim_open_set_point *p = &id->at_fpir[k];
        json_array_append_new(points, json_pack("{s:f, s:o, s:o, s:o}", "fpir", sim_fpir_targets[k],
                                                "threshold", number(p->threshold), "fpir_observed",
                                                rate_json(p->fpir), "fnir", rate_json(p->fnir)));
    }
    json_object_set_new(object, "fnir_at_fpir", points);
    return object;
}

static json_t *conditions_json(const struct sim_analysis *a)
{
    json_t *array = json_array();
    for (size_t i = 0; i < a->n_conditions; i++) {
        const struct sim_condition *c = &a->conditions[i];
        json_array_append_new(array,
                              json_pack("{s:s, s:s, s:o, s:o, s:o, s:o}", "column", c->column,
                                        "value", c->value, "failure_to_acquire",
                                        rate_json(c->not_acquired), "rank_1", rate_json(c->rank_1),
                                        "rank_4", rate_json(c->rank_4), "eer", number(c->eer)));
    }
    return array;
}

static json_t *landmarks_json(const struct sim_landmark_error landmarks[ISO_LANDMARKS])
{
    json_t *object = json_object();
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        const struct sim_landmark_error *e = &landmarks[l];
        if (e->n == 0) {
            continue;
        }
        json_t *figures = json_pack(
            "{s:I, s:f, s:f, s:[f,f,f], s:f, s:f, s:I, s:f, s:f}", "frames", (json_int_t)e->n,
            "mean_mm", e->mean_mm, "p95_mm", e->p95_mm, "offset_mm", e->offset_mm.x, e->offset_mm.y,
            e->offset_mm.z, "centred_mean_mm", e->centred_mean_mm, "centred_p95_mm",
            e->centred_p95_mm, "slip_pairs", (json_int_t)e->n_pairs, "slip_median_mm",
            e->slip_median_mm, "slip_p95_mm", e->slip_p95_mm);
        json_object_set_new(object, iso_landmark_name((enum iso_landmark)l), figures);
    }
    return object;
}

static json_t *latency_json(struct sim_latency latency)
{
    return json_pack("{s:I, s:f, s:f}", "n", (json_int_t)latency.n, "median", latency.median_ms,
                     "p95", latency.p95_ms);
}

static json_t *latencies_json(const struct sim_analysis *a)
{
    json_t *stages = json_object();
    for (int s = 0; s < ISO_STAGES; s++) {
        json_object_set_new(stages, iso_stage_name((enum iso_stage)s), latency_json(a->stage[s]));
    }
    return json_pack("{s:o, s:{s:o, s:o}, s:{s:o, s:o}}", "stages_cpu", stages, "template", "cpu",
                     latency_json(a->extract_cpu), "wall", latency_json(a->extract_wall), "search",
                     "cpu", latency_json(a->search_cpu), "wall", latency_json(a->search_wall));
}

int sim_report_json(const struct sim_eval *eval, const char *directory, struct iso_fault *fault)
{
    const struct sim_analysis *a = eval->analysis;
    char path[4096];
    int length = snprintf(path, sizeof path, "%s/summary.json", directory);
    if (length < 0 || (size_t)length >= sizeof path) {
        return iso_fault_set(fault, -ENAMETOOLONG, "summary.json: path too long");
    }
    json_t *summary = json_pack(
        "{s:i, s:s, s:o, s:o, s:o, s:o, s:{s:I, s:I, s:I}, s:o, s:o, s:o}", "format", 1, "corpus",
        eval->options.corpus, "settings", settings_json(eval), "acquisition",
        acquisition_json(eval), "verification", verification_json(&a->verification),
        "identification", identification_json(eval), "not_faces", "samples",
        (json_int_t)a->n_kind[SIM_PROBE_NONE], "accepted",
        (json_int_t)a->probe_reason[SIM_PROBE_NONE][ISO_CAPTURE_OK], "matched",
        (json_int_t)a->none_matched, "conditions", conditions_json(a), "landmarks",
        landmarks_json(eval->landmarks), "latency_ms", latencies_json(a));
    int error = 0;
    if (!summary) {
        error = iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    } else if (json_dump_file(summary, path, JSON_INDENT(2) | JSON_REAL_PRECISION(8)) != 0) {
        error = iso_fault_set(fault, -EIO, "%s: cannot be written", path);
    }
    json_decref(summary);
    return error;
}
