#include <math.h>

#include "sim/lab/measure/promise.h"
#include "sim/lab/report/report.h"
#include "sim/lab/report/report_calibration.h"

static void print_rate(FILE *out, const char *name, struct sim_rate rate)
{
    struct sim_interval interval = sim_rate_interval(rate);
    fprintf(out, "  %-24s %7.2f %%  [%.2f, %.2f]  (%zu of %zu)\n", name,
            100.0 * sim_rate_value(rate), 100.0 * interval.low, 100.0 * interval.high, rate.events,
            rate.trials);
}

static void print_reasons(FILE *out, const char *of, const size_t reason[SIM_REASONS])
{
    for (int r = 0; r < SIM_REASONS; r++) {
        if (r != ISO_CAPTURE_OK && reason[r] > 0) {
            fprintf(out, "    %-10s %-16s %zu\n", of, sim_reason_name(r), reason[r]);
        }
    }
}

static void print_acquisition(const struct sim_eval *eval, FILE *out)
{
    const struct sim_analysis *a = eval->analysis;
    const size_t n_faces = a->n_kind[SIM_PROBE_MATED] + a->n_kind[SIM_PROBE_STRANGER];
    const size_t acquired = a->probe_reason[SIM_PROBE_MATED][ISO_CAPTURE_OK] +
                            a->probe_reason[SIM_PROBE_STRANGER][ISO_CAPTURE_OK];
    fprintf(out, "Acquisition: %zu of %zu frames usable\n", a->n_usable_captures,
            eval->acquisition->n_captures);
    print_rate(out, "failure to enrol",
               (struct sim_rate){a->n_people_not_enrolled, eval->gallery->n_people});
    print_rate(out, "failure to acquire", (struct sim_rate){n_faces - acquired, n_faces});
    print_reasons(out, "gallery", a->gallery_reason);
    print_reasons(out, "enrolled", a->probe_reason[SIM_PROBE_MATED]);
    print_reasons(out, "strangers", a->probe_reason[SIM_PROBE_STRANGER]);
    print_reasons(out, "not faces", a->probe_reason[SIM_PROBE_NONE]);
}

static void print_verification(const struct sim_verification *v, FILE *out)
{
    fprintf(out, "Verification: %zu mated and %zu non-mated comparisons, %zu mated ones lost\n",
            v->scores.n_mated, v->scores.n_non_mated, v->n_lost);
    if (v->n_det == 0) {
        fputs("  too few comparisons for error rates\n", out);
        return;
    }
    fprintf(out, "  %-24s %7.2f %%  [%.2f, %.2f]\n", "EER", 100.0 * v->eer,
            100.0 * v->eer_interval.low, 100.0 * v->eer_interval.high);
    for (int k = 0; k < SIM_FMR_TARGETS; k++) {
        const struct sim_operating_point *p = &v->at_fmr[k];
        fprintf(out,
                "  FNMR at FMR %-12.0e %7.2f %%  [%.2f, %.2f]  GFNMR %.2f %%  threshold %.3f%s\n",
                sim_fmr_targets[k], 100.0 * p->at.fnmr, 100.0 * p->fnmr.low, 100.0 * p->fnmr.high,
                100.0 * sim_rate_value(p->gfnmr), p->at.threshold,
                p->supported ? "" : "  (too few comparisons)");
    }
    fprintf(out, "  %-24s %7.1e\n", "smallest FMR supported",
            sim_rate_smallest(v->scores.n_non_mated));
}

/* Only the scores of a metric promise error rates. */
static void print_promises(const struct sim_eval *eval, FILE *out)
{
    const struct sim_verification *v = &eval->analysis->verification;
    if (sim_eval_score_kind(eval) != SIM_SCORE_METRIC || v->n_det == 0) {
        return;
    }
    struct sim_promise promises[SIM_PROMISES];
    sim_promises_of(&v->scores, promises);
    fputs("Calibration:  score   FMR promised       FMR %  [95 %]            FNMR %\n", out);
    for (int i = 0; i < SIM_PROMISES; i++) {
        const struct sim_promise *p = &promises[i];
        const struct sim_interval interval = sim_rate_interval(p->false_match);
        fprintf(out, "  %17.1f %14.0e %11.4f  [%.4f, %.4f] %8.2f\n", p->score, pow(10.0, -p->score),
                100.0 * sim_rate_value(p->false_match), 100.0 * interval.low, 100.0 * interval.high,
                100.0 * sim_rate_value(p->non_match));
    }
}

static void print_site(const struct sim_site_split *site, FILE *out)
{
    if (site->splits == 0) {
        return;
    }
    fprintf(out,
            "Site: learned from %zu or %zu of %zu people, judged on the others, %zu splits\n"
            "  offset %.1f standard deviations (%.1f expected), variance within people %.2f times "
            "the rendered one, taken with the weight %.2f\n",
            site->learned, site->people - site->learned, site->people, site->splits, site->offset,
            site->expected, site->growth, site->share);
    print_rate(out, "refused", site->refused);
    fprintf(out, "  %-24s %7.2f %%  (%.2f %% with refused searches)\n", "EER", 100.0 * site->eer,
            100.0 * site->eer_with_refused);
    for (int i = 0; i < SIM_SITE_SCORES; i++) {
        const struct sim_site_rate *at = &site->at[i];
        fprintf(out,
                "  score %.0f: FMR %.3f %% [%.3f, %.3f] (promised %.2f), FNMR %.2f %% [%.2f, "
                "%.2f]\n",
                at->score, 100.0 * at->fmr, 100.0 * at->fmr_interval.low,
                100.0 * at->fmr_interval.high, 100.0 * pow(10.0, -at->score), 100.0 * at->fnmr,
                100.0 * at->fnmr_interval.low, 100.0 * at->fnmr_interval.high);
    }
    print_rate(out, "rank 1", site->rank_1);
}

static void print_identification(const struct sim_eval *eval, FILE *out)
{
    const struct sim_identification *id = &eval->analysis->identification;
    fprintf(out, "Identification: %zu searches of %zu people, %zu searches by strangers\n",
            id->n_searches, eval->gallery->n_people, id->n_strangers);
    if (id->n_searches == 0) {
        return;
    }
    print_rate(out, "rank 1", sim_rank_rate(id->searches, id->n_searches, 1));
    print_rate(out, "rank 4", sim_rank_rate(id->searches, id->n_searches, 4));
    for (int k = 0; k < SIM_FPIR_TARGETS && id->n_strangers > 0; k++) {
        char name[32];
        (void)snprintf(name, sizeof name, "FNIR at FPIR %.0e", sim_fpir_targets[k]);
        print_rate(out, name, id->at_fpir[k].fnir);
    }
    if (id->n_strangers > 0) {
        fprintf(out, "  %-24s %7.1e\n", "smallest FPIR supported",
                sim_rate_smallest(id->n_strangers));
    }
}

static void print_growth(const struct sim_growth *growth, FILE *out)
{
    if (growth->n == 0) {
        return;
    }
    fprintf(
        out,
        "By people enrolled:   FPIR %%    FNIR %%   FNIR %% at FPIR %.0e   (the first two at the "
        "threshold %.3f)\n",
        growth->target_fpir, growth->threshold);
    for (size_t i = 0; i < growth->n; i++) {
        const struct sim_growth_point *p = &growth->points[i];
        fprintf(out, "  %16zu %9.3f %9.2f %12.2f\n", p->n_people, 100.0 * p->fpir, 100.0 * p->fnir,
                100.0 * p->fnir_at_fpir);
    }
}

static void print_curves(const struct sim_eval *eval, FILE *out)
{
    if (eval->analysis->verification.n_det == 0) {
        return;
    }
    fprintf(out,
            "By the conditions of a search (non-matches at FMR %.0e, 95 %% intervals):\n"
            "                       from      mean        to  searches  not rank 1 %%   FNMR %%\n",
            sim_fmr_targets[2]);
    for (int f = 0; f < SIM_FACTORS; f++) {
        const struct sim_curve *curve = &eval->curves[f];
        for (size_t i = 0; i < curve->n_bins && curve->n_bins > 1; i++) {
            const struct sim_curve_bin *b = &curve->bins[i];
            struct sim_interval interval = sim_rate_interval(b->non_match);
            fprintf(out, "  %-15s %9.2f %9.2f %9.2f %9zu %13.2f %8.2f  [%.1f, %.1f]\n",
                    i == 0 ? sim_factor_name((enum sim_factor)f) : "", b->low, b->mean, b->high,
                    b->non_match.trials, 100.0 * sim_rate_value(b->not_rank_1),
                    100.0 * sim_rate_value(b->non_match), 100.0 * interval.low,
                    100.0 * interval.high);
        }
    }
}

static void print_conditions(const struct sim_analysis *a, FILE *out)
{
    if (a->n_conditions > 0) {
        fputs("By condition:              searches    FTA %   rank-1 %   rank-4 %     EER %\n",
              out);
    }
    for (size_t i = 0; i < a->n_conditions; i++) {
        const struct sim_condition *c = &a->conditions[i];
        fprintf(out, "  %-10s %-14s %7zu %8.1f %10.1f %10.1f %9.2f\n", c->column, c->value,
                c->rank_1.trials, 100.0 * sim_rate_value(c->not_acquired),
                100.0 * sim_rate_value(c->rank_1), 100.0 * sim_rate_value(c->rank_4),
                100.0 * c->eer);
    }
}

static void print_landmarks(const struct sim_eval *eval, FILE *out)
{
    if (eval->landmarks[ISO_LANDMARKS].error_mm.n == 0) {
        return;
    }
    fputs("Landmarks, mm:      frames    error    p95   less offset: mean    p95"
          "   slip: median    p95\n",
          out);
    for (int l = 0; l <= ISO_LANDMARKS; l++) {
        const struct sim_landmark_error *e = &eval->landmarks[l];
        if (e->error_mm.n > 0) {
            fprintf(out, "  %-16s %7zu %8.2f %6.2f %19.2f %6.2f %15.2f %6.2f\n",
                    sim_landmark_error_name(l), e->error_mm.n, e->error_mm.mean, e->error_mm.p95,
                    e->centred_error_mm.mean, e->centred_error_mm.p95, e->slip_mm.median,
                    e->slip_mm.p95);
        }
    }
}

static void print_latency(FILE *out, const char *name, struct sim_latency latency)
{
    fprintf(out, "  %-16s %10.2f %10.2f\n", name, latency.median_ms, latency.p95_ms);
}

static void print_latencies(const struct sim_eval *eval, FILE *out)
{
    const struct sim_analysis *a = eval->analysis;
    fprintf(out,
            "Latency, ms:           median        p95   (%zu frames, processor time of a thread)\n",
            a->extract_cpu.n);
    for (int s = 0; s < ISO_STAGES; s++) {
        print_latency(out, iso_stage_name((enum iso_stage)s), a->stage[s]);
    }
    print_latency(out, "template", a->extract_cpu);
    print_latency(out, "search", a->search_cpu);
    print_latency(out, "template, wall", a->extract_wall);
    print_latency(out, "search, wall", a->search_wall);
    fprintf(out, "Took %.1f s on %d threads.\n", (double)eval->wall_ns * 1e-9,
            eval->options.threads);
}

void sim_report_text(const struct sim_eval *eval, FILE *out)
{
    static const char *const scores[] = {
        [SIM_SCORE_PAIRWISE] = "negative distance",
        [SIM_SCORE_METRIC] = "learned metric",
        [SIM_SCORE_COHORT] = "cohort-normalised",
        [SIM_SCORE_DISTANCE] = "negative distance, mm (no cohort)",
    };
    const struct sim_analysis *a = eval->analysis;
    fprintf(out, "Corpus %s; method: %s; score: %s\n", eval->options.corpus,
            sim_eval_first(eval)->name, scores[sim_eval_score_kind(eval)]);
    print_acquisition(eval, out);
    print_verification(&a->verification, out);
    print_promises(eval, out);
    sim_report_calibration(&eval->calibration, out);
    print_site(&eval->site, out);
    sim_report_calibration(&eval->site.calibration, out);
    print_identification(eval, out);
    if (a->n_kind[SIM_PROBE_NONE] > 0) {
        fprintf(out, "Not faces: %zu of %zu taken for a face, %zu would match at FMR %.0e\n",
                a->probe_reason[SIM_PROBE_NONE][ISO_CAPTURE_OK], a->n_kind[SIM_PROBE_NONE],
                a->none_matched, sim_fmr_targets[2]);
    }
    print_growth(&eval->growth, out);
    print_conditions(a, out);
    print_curves(eval, out);
    print_landmarks(eval, out);
    print_latencies(eval, out);
}
