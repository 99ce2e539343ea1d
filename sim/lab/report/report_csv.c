#include "sim/base/result_file.h"
#include "sim/lab/report/landmark_lines.h"
#include "sim/lab/report/report.h"

static void write_scores(const void *context, FILE *out)
{
    const struct sim_eval *eval = context;
    fputs("probe_recording,probe_frame,probe_subject,gallery_subject,distance,score,outcome\n",
          out);
    const struct sim_matches *m = eval->matches;
    for (size_t i = 0; i < m->n_probes; i++) {
        const struct sim_sample *sample = &eval->acquisition->samples[m->sample[i]];
        const struct sim_corpus_row *row = &eval->corpus->rows[sample->row];
        const size_t frame = eval->acquisition->captures[sample->first_capture].frame;
        if (!sample->acquired) {
            fprintf(out, "%s,%zu,%s,,,,fta:%s\n", row->recording, frame, row->subject,
                    sim_reason_name(sample->reason));
            continue;
        }
        const size_t mate = eval->analysis->mate[i];
        for (size_t p = 0; p < m->n_people; p++) {
            if (eval->gallery->n_templates_of[p] > 0) {
                fprintf(out, "%s,%zu,%s,%s,%.6f,%.6f,ok\n", row->recording, frame, row->subject,
                        eval->gallery->names[p], m->distance_mm[i * m->n_people + p],
                        sim_matches_compared(m, i, p, mate));
            }
        }
    }
}

static void write_landmarks(const void *context, FILE *out)
{
    const struct sim_eval *eval = context;
    sim_report_landmarks_header(out);
    for (size_t i = 0; i < eval->acquisition->n_captures; i++) {
        const struct sim_capture *c = &eval->acquisition->captures[i];
        if (c->extraction.outcome == ISO_CAPTURE_OK) {
            sim_report_landmarks(eval->corpus->rows[c->row].recording, c->frame,
                                 c->extraction.landmark_mm, out);
        }
    }
}

static void write_cmc(const void *context, FILE *out)
{
    const struct sim_eval *eval = context;
    const struct sim_identification *id = &eval->analysis->identification;
    fputs("rank,identified,searches,rate,low,high\n", out);
    for (size_t rank = 1; rank <= eval->gallery->n_people && id->n_searches > 0; rank++) {
        struct sim_rate rate = sim_rank_rate(id->searches, id->n_searches, rank);
        struct sim_interval interval = sim_rate_interval(rate);
        fprintf(out, "%zu,%zu,%zu,%.6f,%.6f,%.6f\n", rank, rate.events, rate.trials,
                sim_rate_value(rate), interval.low, interval.high);
    }
}

static void write_det(const void *context, FILE *out)
{
    const struct sim_eval *eval = context;
    const struct sim_verification *v = &eval->analysis->verification;
    fputs("threshold,fmr,fnmr\n", out);
    for (size_t i = 0; i < v->n_det; i++) {
        fprintf(out, "%.6f,%.8f,%.8f\n", v->det[i].threshold, v->det[i].fmr, v->det[i].fnmr);
    }
}

static void write_curves(const void *context, FILE *out)
{
    const struct sim_eval *eval = context;
    fputs("factor,low,mean,high,searches,not_rank_1,non_matches,fnmr,fnmr_low,fnmr_high\n", out);
    for (int f = 0; f < SIM_FACTORS; f++) {
        for (size_t i = 0; i < eval->curves[f].n_bins; i++) {
            const struct sim_curve_bin *b = &eval->curves[f].bins[i];
            struct sim_interval interval = sim_rate_interval(b->non_match);
            fprintf(out, "%s,%.6f,%.6f,%.6f,%zu,%zu,%zu,%.6f,%.6f,%.6f\n",
                    sim_factor_name((enum sim_factor)f), b->low, b->mean, b->high,
                    b->non_match.trials, b->not_rank_1.events, b->non_match.events,
                    sim_rate_value(b->non_match), interval.low, interval.high);
        }
    }
}

static void write_growth(const void *context, FILE *out)
{
    const struct sim_eval *eval = context;
    fputs("people,fpir,fnir,fnir_at_fpir\n", out);
    for (size_t i = 0; i < eval->growth.n; i++) {
        const struct sim_growth_point *p = &eval->growth.points[i];
        fprintf(out, "%zu,%.8f,%.8f,%.8f\n", p->n_people, p->fpir, p->fnir, p->fnir_at_fpir);
    }
}

int sim_report_csv(const struct sim_eval *eval, const char *directory, struct iso_fault *fault)
{
    static const struct {
        const char *name;
        sim_result_writer *rows;
    } files[] = {
        {"scores.csv", write_scores}, {"landmarks.csv", write_landmarks},
        {"cmc.csv", write_cmc},       {"det.csv", write_det},
        {"growth.csv", write_growth}, {"curves.csv", write_curves},
    };
    int error = 0;
    for (size_t i = 0; !error && i < sizeof files / sizeof *files; i++) {
        error = sim_result_file(directory, files[i].name, files[i].rows, eval, fault);
    }
    return error;
}
