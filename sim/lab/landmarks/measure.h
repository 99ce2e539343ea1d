/* Runs the extractor on every frame of a corpus and compares the results with the truth. */
#ifndef SIM_LAB_LANDMARKS_MEASURE_H
#define SIM_LAB_LANDMARKS_MEASURE_H

#include "sim/lab/eval/landmark_error.h"
#include "sim/lab/match/capture.h"

/* The result of a frame's extraction without the template. */
struct sim_measured_frame {
    size_t row, frame; /* row of the corpus; frame of the recording */
    int reason;        /* as sim_capture_reason */
    bool fitted;       /* a head was fitted, whether or not the gates accepted the frame */
    struct iso_vec3 landmark_mm[ISO_LANDMARKS]; /* camera frame; if fitted */
    double yaw_rad, pitch_rad, roll_rad;        /* angles as in iso_extraction */
    double distance_mm, residual_mm, coverage;
    int64_t cpu_ns, stage_ns[ISO_STAGES]; /* 0: the stage was not reached */

    /* Comparison with the truth, without a frame's unknown landmarks. */
    size_t n_known; /* landmarks that are found and known; 0: the next five fields are not set */
    struct sim_deviation deviation;
    double error_mean_mm, error_max_mm;
    double centred_mean_mm, centred_max_mm; /* without the constant offset of each landmark */
    double true_angle_rad;                  /* as sim_true_angle; NaN if unknown */
};

struct sim_measurement {
    size_t n_frames; /* sim_corpus_frames, in the order of rows, then frames */
    struct sim_measured_frame *frames;
    struct iso_vec3 offset_mm[ISO_LANDMARKS]; /* sim_measure_offsets */
    struct sim_capture_origin origin;
};

/* Computes sim_landmark_offsets over all fitted frames of people, accepted or not. -ENOMEM. */
int sim_measure_offsets(const struct sim_corpus *corpus, const struct sim_measured_frame *frames,
                        size_t n_frames, struct iso_vec3 offset_mm[ISO_LANDMARKS])
    __attribute__((warn_unused_result));

/* Sets a frame's errors from its deviation and the offsets; for `n_known` > 0. */
void sim_measure_frame_errors(const struct iso_vec3 offset_mm[ISO_LANDMARKS],
                              struct sim_measured_frame *frame);

/* Runs the extractor on all frames and compares the landmarks with the truth. Errors of
 * sim_capture_all and sim_truth_read; -ENOMEM; each with a fault. */
int sim_measure(const char *directory, const struct sim_corpus *corpus,
                const struct sim_capture_options *options, struct sim_measurement **out,
                struct iso_fault *fault) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_measurement_free(struct sim_measurement *measurement);

#endif
