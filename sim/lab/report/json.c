#include "sim/lab/report/json.h"

#include <errno.h>
#include <math.h>

json_t *sim_json_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *rate_with(struct sim_rate rate, struct sim_interval interval)
{
    return json_pack("{s:o, s:f, s:f, s:I, s:I}", "rate", sim_json_number(sim_rate_value(rate)),
                     "low", interval.low, "high", interval.high, "events", (json_int_t)rate.events,
                     "trials", (json_int_t)rate.trials);
}

json_t *sim_json_rate(struct sim_rate rate)
{
    return rate_with(rate, sim_rate_interval(rate));
}

json_t *sim_json_exact_rate(struct sim_rate rate)
{
    return rate_with(rate, sim_rate_exact_interval(rate));
}

json_t *sim_json_extract(const struct iso_extract_options *x)
{
    json_t *radii = json_array();
    for (int r = 0; r < x->n_radii; r++) {
        json_array_append_new(radii, sim_json_number(x->radius_mm[r]));
    }
    json_t *fit = json_pack("{s:i, s:i, s:f, s:f, s:f, s:f, s:f}", "rigid_iterations",
                            x->fit.rigid_iterations, "iterations", x->fit.iterations,
                            "cutoff_first_mm", x->fit.cutoff_first_mm, "cutoff_last_mm",
                            x->fit.cutoff_last_mm, "soft_weight", x->fit.soft_weight,
                            "identity_stiffness_mm2", x->fit.identity_stiffness_mm2,
                            "expression_stiffness_mm2", x->fit.expression_stiffness_mm2);
    return json_pack("{s:s, s:f, s:o, s:i, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:o}", "heat",
                     iso_heat_method_name(x->heat), "t_mm2", x->t_mm2, "radii_mm", radii, "points",
                     x->n_points, "crop_radius_mm", x->crop_radius_mm, "spacing_mm", x->spacing_mm,
                     "smoothing_mm", x->smoothing_mm, "outlier_mm", x->outlier_mm,
                     "distance_min_mm", x->distance_min_mm, "distance_max_mm", x->distance_max_mm,
                     "yaw_max_rad", x->yaw_max_rad, "pitch_max_rad", x->pitch_max_rad, "fit", fit);
}

json_t *sim_json_landmarks(const struct sim_landmark_error errors[ISO_LANDMARKS + 1])
{
    json_t *object = json_object();
    for (int l = 0; l <= ISO_LANDMARKS; l++) {
        const struct sim_landmark_error *e = &errors[l];
        if (e->error_mm.n == 0) {
            continue;
        }
        json_t *figures = json_pack(
            "{s:I, s:f, s:f, s:f, s:[f,f,f], s:f, s:f, s:f, s:I, s:f, s:f, s:I, s:f, s:f}",
            "frames", (json_int_t)e->error_mm.n, "mean_mm", e->error_mm.mean, "median_mm",
            e->error_mm.median, "p95_mm", e->error_mm.p95, "offset_mm", e->offset_mm.x,
            e->offset_mm.y, e->offset_mm.z, "centred_mean_mm", e->centred_error_mm.mean,
            "centred_median_mm", e->centred_error_mm.median, "centred_p95_mm",
            e->centred_error_mm.p95, "repeats", (json_int_t)e->repeat_mm.n, "repeat_median_mm",
            e->repeat_mm.median, "repeat_p95_mm", e->repeat_mm.p95, "slip_pairs",
            (json_int_t)e->slip_mm.n, "slip_median_mm", e->slip_mm.median, "slip_p95_mm",
            e->slip_mm.p95);
        json_object_set_new(object, sim_landmark_error_name(l), figures);
    }
    return object;
}

json_t *sim_json_latency(struct sim_latency latency)
{
    return json_pack("{s:I, s:f, s:f}", "n", (json_int_t)latency.n, "median", latency.median_ms,
                     "p95", latency.p95_ms);
}

static int write_file(json_t *document, size_t flags, const char *path, struct iso_fault *fault)
{
    int error = 0;
    if (!document) {
        error = iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    } else if (json_dump_file(document, path, JSON_INDENT(2) | flags) != 0) {
        error = iso_fault_set(fault, -EIO, "%s: cannot be written", path);
    }
    json_decref(document);
    return error;
}

int sim_json_file(json_t *document, const char *path, struct iso_fault *fault)
{
    return write_file(document, JSON_REAL_PRECISION(8), path, fault);
}

int sim_json_file_exact(json_t *document, const char *path, struct iso_fault *fault)
{
    return write_file(document, JSON_REAL_PRECISION(17), path, fault);
}
