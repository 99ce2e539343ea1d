#include "sim/lab/landmarks/study.h"

enum { RATE_COLUMNS = 40 }; /* characters of a column with a rate */

/* Prints columns like "1.25 [ 0.40,   2.88] (5 of 400)": percent, exact 95% interval. No line end.
 */
static void print_rates(FILE *out, const struct sim_rate *rates, int n)
{
    for (int i = 0; i < n; i++) {
        char text[96] = "     -  none to count";
        if (rates[i].trials > 0) {
            struct sim_interval ends = sim_rate_exact_interval(rates[i]);
            (void)snprintf(text, sizeof text, "%6.2f [%5.2f, %6.2f] (%zu of %zu)",
                           100.0 * sim_rate_value(rates[i]), 100.0 * ends.low, 100.0 * ends.high,
                           rates[i].events, rates[i].trials);
        }
        fprintf(out, "%-*s", i + 1 < n ? RATE_COLUMNS : 0, text);
    }
}

static void print_named_rates(FILE *out, const char *name, const struct sim_rate *rates, int n)
{
    fprintf(out, "  %-26s", name);
    print_rates(out, rates, n);
    fputc('\n', out);
}

static void print_heading(FILE *out, const char *first, const char *const *columns, int n)
{
    fprintf(out, "  %-26s", first);
    for (int i = 0; i < n; i++) {
        fprintf(out, "%-*s", i + 1 < n ? RATE_COLUMNS : 0, columns[i]);
    }
    fputc('\n', out);
}

/* ---- landmarks -------------------------------------------------------------------- */

static void print_landmark(FILE *out, const char *name, const struct sim_landmark_error *e)
{
    fprintf(out, "  %-14s %6zu %6.2f %6.2f %6.2f  %6.2f %6.2f %6.2f  %6.2f %6.2f %6.2f", name,
            e->error_mm.n, e->error_mm.mean, e->error_mm.median, e->error_mm.p95, e->offset_mm.x,
            e->offset_mm.y, e->offset_mm.z, e->centred_error_mm.mean, e->centred_error_mm.median,
            e->centred_error_mm.p95);
    if (e->repeat_mm.n > 0) {
        fprintf(out, "  %6.2f %6.2f", e->repeat_mm.median, e->repeat_mm.p95);
    } else {
        fprintf(out, "  %6s %6s", "-", "-");
    }
    if (e->slip_mm.n > 0) {
        fprintf(out, "  %6.2f %6.2f\n", e->slip_mm.median, e->slip_mm.p95);
    } else {
        fprintf(out, "  %6s %6s\n", "-", "-");
    }
}

static void print_landmarks(const struct sim_landmark_analysis *a, FILE *out)
{
    if (a->before[ISO_LANDMARKS].error_mm.n == 0) {
        fputs("Landmarks: no ground truth\n", out);
        return;
    }
    fputs("Landmarks, mm, of accepted frames; face frame (x to the subject's left, y up, z out)\n"
          "                                  error  ----- offset -----    less the offset  "
          "betw. sessions   pairwise slip\n"
          "                      n   mean median    p95       x      y      z    mean median    p95"
          "  median    p95  median    p95\n",
          out);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        if (a->after[l].error_mm.n > 0) {
            print_landmark(out, sim_landmark_error_name(l), &a->after[l]);
        }
    }
    print_landmark(out, "all", &a->after[ISO_LANDMARKS]);
    print_landmark(out, "all, no gates", &a->before[ISO_LANDMARKS]);
}

/* ---- failures --------------------------------------------------------------------- */

static void print_failures(const struct sim_condition_figures *all, FILE *out)
{
    static const char *const columns[] = {"before the gates", "after the gates",
                                          "good frames refused"};
    fprintf(out,
            "Failures, %% of frames with ground truth and a fit: more than %.0f mm off, by the "
            "mean over a frame's landmarks,\n"
            "the mean less each landmark's constant offset, the worst of the latter\n",
            SIM_FAILURE_MM);
    print_heading(out, "", columns, 3);
    for (int r = 0; r < SIM_FAILURE_RULES; r++) {
        const struct sim_failures *f = &all->failures[r];
        const struct sim_rate rates[] = {f->before, f->after, f->good_refused};
        print_named_rates(out, sim_failure_rule_name((enum sim_failure_rule)r), rates, 3);
    }
}

static void print_condition_errors(const struct sim_condition_figures *c, const char *name,
                                   FILE *out)
{
    fprintf(out, "  %-26s%7zu %7.2f %6.2f %6.2f %7.2f %6.2f %6.2f  ", name, c->refused.trials,
            c->error_mm.mean, c->error_mm.median, c->error_mm.p95, c->centred_error_mm.mean,
            c->centred_error_mm.median, c->centred_error_mm.p95);
    print_rates(out, &c->refused, 1);
    fputc('\n', out);
}

static void print_condition_failures(const struct sim_condition_figures *c, const char *name,
                                     FILE *out)
{
    const struct sim_failures *mean = &c->failures[SIM_FAILURE_MEAN];
    const struct sim_failures *centred = &c->failures[SIM_FAILURE_CENTRED_MEAN];
    const struct sim_rate rates[] = {mean->before, mean->after, centred->before, centred->after};
    print_named_rates(out, name, rates, 4);
}

static void each_condition(const struct sim_landmark_analysis *a,
                           void (*print)(const struct sim_condition_figures *c, const char *name,
                                         FILE *out),
                           FILE *out)
{
    for (size_t i = 0; i < a->n_conditions; i++) {
        char name[96];
        (void)snprintf(name, sizeof name, "%s %s", a->conditions[i].column, a->conditions[i].value);
        print(&a->conditions[i], name, out);
    }
    print(&a->all, "all", out);
}

static void print_conditions(const struct sim_landmark_analysis *a, FILE *out)
{
    static const char *const columns[] = {"mean, before the gates", "mean, after the gates",
                                          "less offset, before", "less offset, after"};
    fputs("By the true angle between face and camera (yaw and pitch together, degrees) and by "
          "expression: accepted frames, mm\n"
          "                             frames          error            less the offset\n"
          "                                       mean median    p95    mean median    p95"
          "  frames refused, %\n",
          out);
    each_condition(a, print_condition_errors, out);
    if (a->n_true > 0) {
        fprintf(out, "Failures (> %.0f mm) by condition, %%\n", SIM_FAILURE_MM);
        print_heading(out, "", columns, 4);
        each_condition(a, print_condition_failures, out);
    }
}

/* ---- gates ------------------------------------------------------------------------ */

static void print_reasons(const size_t reason[SIM_REASONS], FILE *out)
{
    for (int r = 0; r < SIM_REASONS; r++) {
        if (r != ISO_CAPTURE_OK && reason[r] > 0) {
            fprintf(out, "  %s %zu", sim_reason_name(r), reason[r]);
        }
    }
}

static void print_refusals(const struct sim_landmark_analysis *a, FILE *out)
{
    fputs("Genuine frames refused, %\n", out);
    print_named_rates(out, "all", &a->all.refused, 1);
    for (int r = 0; r < SIM_REASONS; r++) {
        if (r != ISO_CAPTURE_OK && a->reason[r] > 0) {
            const struct sim_rate rate = {a->reason[r], a->n_bona_fide};
            print_named_rates(out, sim_reason_name(r), &rate, 1);
        }
    }
}

static void print_not_faces(const struct sim_landmark_analysis *a, FILE *out)
{
    struct sim_rate all = {0, 0};
    bool heading = true;
    for (size_t i = 0; i < a->n_kinds; i++) {
        const struct sim_kind_figures *k = &a->kinds[i];
        if (k->kind != SIM_ROW_NOT_A_FACE) {
            continue;
        }
        if (heading) {
            fputs("Non-faces: frames accepted, %; answers to the others\n", out);
            heading = false;
        }
        fprintf(out, "  %-26s", *k->note ? k->note : "(no note)");
        print_rates(out, &k->accepted_frames, 1);
        print_reasons(k->reason, out);
        fputc('\n', out);
        all.events += k->accepted_frames.events;
        all.trials += k->accepted_frames.trials;
    }
    if (!heading) {
        print_named_rates(out, "all", &all, 1);
    }
}

static void print_attacks(const struct sim_landmark_analysis *a, FILE *out)
{
    static const char *const columns[] = {"APCER", "APNRR (no response)", "frames accepted"};
    const struct sim_kind_figures *worst = NULL;
    for (size_t i = 0; i < a->n_kinds; i++) {
        const struct sim_kind_figures *k = &a->kinds[i];
        if (k->kind != SIM_ROW_ATTACK) {
            continue;
        }
        if (!worst) {
            fputs("Presentation attacks (ISO/IEC 30107-3), % of presentations (rows)\n", out);
            print_heading(out, "species", columns, 3);
        }
        fprintf(out, "  %-26s", k->note);
        const struct sim_rate rates[] = {k->response[SIM_RESPONSE_BONA_FIDE],
                                         k->response[SIM_RESPONSE_NONE], k->accepted_frames};
        print_rates(out, rates, 3);
        print_reasons(k->reason, out);
        fputc('\n', out);
        if (!worst || sim_rate_value(k->response[SIM_RESPONSE_BONA_FIDE]) >
                          sim_rate_value(worst->response[SIM_RESPONSE_BONA_FIDE])) {
            worst = k;
        }
    }
    if (worst) {
        print_named_rates(out, "worst species: APCER", &worst->response[SIM_RESPONSE_BONA_FIDE], 1);
    }
    if (a->bona_fide[SIM_RESPONSE_BONA_FIDE].trials > 0) {
        fputs("Bona fide presentations (rows with a subject), %\n", out);
        print_named_rates(out, "BPCER (taken for attacks)", &a->bona_fide[SIM_RESPONSE_ATTACK], 1);
        print_named_rates(out, "BPNRR (no response)", &a->bona_fide[SIM_RESPONSE_NONE], 1);
    }
}

static void print_times(const struct sim_study *study, FILE *out)
{
    const struct sim_landmark_analysis *a = study->analysis;
    fputs("Processor time of a thread, ms:   frames   median      p95\n", out);
    for (int s = 0; s <= ISO_STAGES; s++) {
        struct sim_latency t = s < ISO_STAGES ? a->stage[s] : a->whole;
        if (t.n > 0) {
            fprintf(out, "  %-28s %9zu %8.2f %8.2f\n",
                    s < ISO_STAGES ? iso_stage_name((enum iso_stage)s) : "whole frame", t.n,
                    t.median_ms, t.p95_ms);
        }
    }
    fprintf(out, "Took %.1f s on %d threads.\n", (double)study->wall_ns * 1e-9,
            study->options.threads);
}

void sim_study_text(const struct sim_study *study, FILE *out)
{
    const struct sim_landmark_analysis *a = study->analysis;
    fprintf(out,
            "Corpus %s: %zu frames of %zu rows; %zu frames of people, %zu of them with a fit and "
            "ground truth\nIntervals are exact (Clopper and Pearson), 95%%.\n",
            study->options.corpus, study->measurement->n_frames, study->corpus->n_rows,
            a->n_bona_fide, a->n_true);
    if (a->n_bona_fide > 0) {
        print_landmarks(a, out);
        if (a->n_true > 0) {
            print_failures(&a->all, out);
        }
        print_conditions(a, out);
        print_refusals(a, out);
    }
    print_not_faces(a, out);
    print_attacks(a, out);
    print_times(study, out);
}
