#include "sim/lab/landmarks/measure.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "sim/lab/landmarks/presentation.h"
#include "sim/lab/landmarks/true_angle.h"

struct measuring {
    struct sim_measurement *measurement;
    const struct sim_truth *truth; /* of each frame */
};

static void keep(void *context, size_t number, const struct sim_capture *capture)
{
    const struct measuring *work = context;
    const struct iso_extraction *x = &capture->extraction;
    struct sim_measured_frame *f = &work->measurement->frames[number];
    *f = (struct sim_measured_frame){
        .row = capture->row,
        .frame = capture->frame,
        .reason = sim_capture_reason(capture),
        .fitted = x->fitted,
        .yaw_rad = x->yaw_rad,
        .pitch_rad = x->pitch_rad,
        .roll_rad = x->roll_rad,
        .distance_mm = x->distance_mm,
        .residual_mm = x->residual_mm,
        .coverage = x->coverage,
        .cpu_ns = capture->cpu_ns,
    };
    memcpy(f->stage_ns, x->stage_ns, sizeof f->stage_ns);
    if (f->fitted) {
        memcpy(f->landmark_mm, x->landmark_mm, sizeof f->landmark_mm);
        f->deviation = sim_deviation_of(x, &work->truth[number], capture->row);
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            f->n_known += f->deviation.known[l];
        }
    }
}

void sim_measure_frame_errors(const struct iso_vec3 offset_mm[ISO_LANDMARKS],
                              struct sim_measured_frame *frame)
{
    double sum = 0.0, centred_sum = 0.0;
    frame->error_max_mm = frame->centred_max_mm = 0.0;
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        if (frame->deviation.known[l]) {
            const double error = iso_norm(frame->deviation.error_mm[l]);
            const double centred = iso_norm(iso_sub(frame->deviation.error_mm[l], offset_mm[l]));
            sum += error;
            centred_sum += centred;
            frame->error_max_mm = fmax(frame->error_max_mm, error);
            frame->centred_max_mm = fmax(frame->centred_max_mm, centred);
        }
    }
    frame->error_mean_mm = sum / (double)frame->n_known;
    frame->centred_mean_mm = centred_sum / (double)frame->n_known;
}

int sim_measure_offsets(const struct sim_corpus *corpus, const struct sim_measured_frame *frames,
                        size_t n_frames, struct iso_vec3 offset_mm[ISO_LANDMARKS])
{
    struct sim_deviation *deviations = calloc(n_frames + 1, sizeof *deviations);
    size_t n = 0;
    if (!deviations) {
        return -ENOMEM;
    }
    for (size_t i = 0; i < n_frames; i++) {
        if (frames[i].n_known > 0 &&
            sim_row_kind_of(&corpus->rows[frames[i].row]) == SIM_ROW_BONA_FIDE) {
            deviations[n++] = frames[i].deviation;
        }
    }
    const int error = sim_landmark_offsets(deviations, n, offset_mm);
    free(deviations);
    return error;
}

static int new_measurement(size_t n_frames, struct sim_measurement **out)
{
    struct sim_measurement *m = calloc(1, sizeof *m);
    *out = m;
    if (m) {
        m->n_frames = n_frames;
        m->frames = calloc(n_frames, sizeof *m->frames);
    }
    return m && m->frames ? 0 : -ENOMEM;
}

int sim_measure(const char *directory, const struct sim_corpus *corpus,
                const struct sim_capture_options *options, struct sim_measurement **out,
                struct iso_fault *fault)
{
    struct sim_measurement *m = NULL;
    struct sim_truth *truth = NULL;
    int error = sim_truth_read(directory, corpus, &truth, fault);
    if (error) {
        return error;
    }
    error = new_measurement(sim_corpus_frames(corpus), &m);
    if (error) {
        (void)iso_fault_set(fault, error, "%s: out of memory", directory);
        goto out;
    }
    struct measuring work = {m, truth};
    error = sim_capture_all(directory, corpus, options, keep, &work, &m->origin, fault);
    if (error) {
        goto out;
    }
    error = sim_measure_offsets(corpus, m->frames, m->n_frames, m->offset_mm);
    if (error) {
        (void)iso_fault_set(fault, error, "%s: out of memory", directory);
        goto out;
    }
    for (size_t i = 0; i < m->n_frames; i++) {
        struct sim_measured_frame *f = &m->frames[i];
        f->true_angle_rad = sim_true_angle(options->model, &truth[i], corpus->rows[f->row].pose);
        if (f->n_known > 0) {
            sim_measure_frame_errors(m->offset_mm, f);
        }
    }
    *out = m;
out:
    free(truth);
    if (error) {
        sim_measurement_free(m);
    }
    return error;
}

void sim_measurement_free(struct sim_measurement *measurement)
{
    if (measurement) {
        free(measurement->frames);
        free(measurement);
    }
}
