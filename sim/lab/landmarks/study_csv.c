#include <math.h>
#include <stdio.h>

#include "sim/base/result_file.h"
#include "sim/lab/landmarks/study.h"
#include "sim/lab/report/landmark_lines.h"

static double degrees(double rad)
{
    return rad * 180.0 / M_PI;
}

static void write_landmarks(const void *context, FILE *out)
{
    const struct sim_study *study = context;
    sim_report_landmarks_header(out);
    for (size_t i = 0; i < study->measurement->n_frames; i++) {
        const struct sim_measured_frame *f = &study->measurement->frames[i];
        if (f->fitted) {
            sim_report_landmarks(study->corpus->rows[f->row].recording, f->frame, f->landmark_mm,
                                 out);
        }
    }
}

/* Writes a field, which is empty if the figure is missing. */
static void write_number(FILE *out, bool known, double value)
{
    if (known) {
        fprintf(out, ",%.3f", value);
    } else {
        fputc(',', out);
    }
}

static void write_frame(const struct sim_corpus_row *row, const struct sim_measured_frame *f,
                        FILE *out)
{
    const struct {
        bool known;
        double value;
    } figures[] = {
        {f->n_known > 0, f->error_mean_mm},
        {f->n_known > 0, f->error_max_mm},
        {f->n_known > 0, f->centred_mean_mm},
        {f->n_known > 0, f->centred_max_mm},
        {!isnan(f->true_angle_rad), degrees(f->true_angle_rad)},
        {f->fitted, f->residual_mm},
        {f->fitted, f->coverage},
        {f->fitted, degrees(f->yaw_rad)},
        {f->fitted, degrees(f->pitch_rad)},
        {f->fitted, degrees(f->roll_rad)},
        {f->fitted, f->distance_mm},
    };
    fprintf(out, "%s,%zu,%s,%s,%s,%s,%s,%s,%s,%d", row->recording, f->frame, row->subject,
            row->session, sim_role_name(row->role), row->pose, row->expression, row->note,
            sim_reason_name(f->reason), (int)f->fitted);
    for (size_t k = 0; k < sizeof figures / sizeof *figures; k++) {
        write_number(out, figures[k].known, figures[k].value);
    }
    for (int s = 0; s < ISO_STAGES; s++) {
        write_number(out, f->stage_ns[s] > 0, (double)f->stage_ns[s] * 1e-6);
    }
    fputc('\n', out);
}

static void write_frames(const void *context, FILE *out)
{
    const struct sim_study *study = context;
    fputs("recording,frame,subject,session,role,pose,expression,note,outcome,fitted,"
          "error_mean_mm,error_max_mm,centred_mean_mm,centred_max_mm,true_angle_deg,"
          "residual_mm,coverage,yaw_deg,pitch_deg,roll_deg,distance_mm",
          out);
    for (int s = 0; s < ISO_STAGES; s++) {
        fprintf(out, ",%s_ms", iso_stage_name((enum iso_stage)s));
    }
    fputc('\n', out);
    for (size_t i = 0; i < study->measurement->n_frames; i++) {
        const struct sim_measured_frame *f = &study->measurement->frames[i];
        write_frame(&study->corpus->rows[f->row], f, out);
    }
}

int sim_study_csv(const struct sim_study *study, const char *directory, struct iso_fault *fault)
{
    const int error = sim_result_file(directory, "landmarks.csv", write_landmarks, study, fault);
    if (error) {
        return error;
    }
    return sim_result_file(directory, "frames.csv", write_frames, study, fault);
}
