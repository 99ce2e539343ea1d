/* The extractor's result for every frame of a corpus, compared with the truth frame by frame. */
#ifndef SIM_LAB_LANDMARKS_MEASURE_H
#define SIM_LAB_LANDMARKS_MEASURE_H

#include "sim/lab/eval/landmark_error.h"
#include "sim/lab/match/capture.h"

/* What is kept of a frame's extraction: everything but the template. */
struct sim_measured_frame {
    size_t row, frame; /* of the corpus; of the recording */
    int reason;        /* as sim_capture_reason */
    bool fitted;       /* a head was fitted, whatever the gates said afterwards: */
    struct iso_vec3 landmark_mm[ISO_LANDMARKS]; /* camera frame; if fitted */
    double yaw_rad, pitch_rad, roll_rad;        /* these as in iso_extraction */
    double distance_mm, residual_mm, coverage;
    int64_t cpu_ns, stage_ns[ISO_STAGES]; /* 0: a stage that was not reached */

    /* Against the truth; unknown landmarks of a frame are left out. */
    size_t n_known; /* landmarks found and known; 0: the next five are not set */
    struct sim_deviation deviation;
    double error_mean_mm, error_max_mm;
    double centred_mean_mm, centred_max_mm; /* less the constant offset of each landmark */
    double true_angle_rad;                  /* as sim_true_angle; NaN if it cannot be told */
};

struct sim_measurement {
    size_t n_frames; /* sim_corpus_frames, in the order of rows, then frames */
    struct sim_measured_frame *frames;
    struct iso_vec3 offset_mm[ISO_LANDMARKS]; /* sim_measure_offsets */
    struct sim_capture_origin origin;
};

/* sim_landmark_offsets of all fitted frames of people, whatever the gates said. -ENOMEM. */
int sim_measure_offsets(const struct sim_corpus *corpus, const struct sim_measured_frame *frames,
                        size_t n_frames, struct iso_vec3 offset_mm[ISO_LANDMARKS])
    __attribute__((warn_unused_result));

/* What a frame's deviation and the offsets say about its errors; for `n_known` > 0. */
void sim_measure_frame_errors(const struct iso_vec3 offset_mm[ISO_LANDMARKS],
                              struct sim_measured_frame *frame);

/* Errors of sim_capture_all and sim_truth_read. */
int sim_measure(const char *directory, const struct sim_corpus *corpus,
                const struct sim_capture_options *options, struct sim_measurement **out,
                struct iso_fault *fault) __attribute__((warn_unused_result));
void sim_measurement_free(struct sim_measurement *measurement);

#endif
