/* A studio turns scenes into the recordings of a corpus. It holds one sensor, the sensor's view,
 * and the manifest, to which every recording adds a row. */
#ifndef SIM_WORLD_GENERATE_STUDIO_H
#define SIM_WORLD_GENERATE_STUDIO_H

#include "core/base/fault.h"
#include "sim/corpus/corpus.h"
#include "sim/world/face/ict.h"
#include "sim/world/scene/sitter.h"
#include "sim/world/sensor/sensor.h"

struct sim_studio_options {
    const struct sim_ict *ict;
    const struct sim_sensor *sensor;
    const char *directory; /* of the corpus */
    double noise_scale;
    int png_level; /* 1 fast .. 9 small */
    bool marks;    /* landmarks.csv has the 25 points of sim/lab/methods/anthroface.h, not only the
                      twelve */
    bool infrared; /* recordings have ir/; its noise uses a random stream of its own, so that the
                      depths stay the same */
};

struct sim_studio;

/* Creates the corpus directory if it does not exist. The objects that the options point to must
 * outlive the studio. -EINVAL, -ENOMEM, or the errno of mkdir. */
int sim_studio_new(const struct sim_studio_options *options, struct sim_studio **out,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_studio_free(struct sim_studio *studio);

/* Draws the scene at frame number `frame` into a cleared view. Sets *truth_known to whether it
 * filled in *truth. Returns 0 or a negative errno. */
typedef int sim_draw_frame(void *scene, int frame, struct sim_view *view, struct sim_truth *truth,
                           bool *truth_known);

/* Records row->count frames of a scene, with time stamps 1/30 s apart, as row->recording, with
 * ground truth where it is known, and adds the row to the manifest (row->first must be 0).
 * `random` supplies the sensor's noise. Errors of drawing and of writing. */
int sim_studio_record(struct sim_studio *studio, const struct sim_corpus_row *row,
                      sim_draw_frame *draw, void *scene, struct sim_random *random,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* The same, but only the first frame is measured. All others repeat it bit by bit, like an
 * attack that feeds a stored frame to the appliance. */
int sim_studio_record_frozen(struct sim_studio *studio, const struct sim_corpus_row *row,
                             sim_draw_frame *draw, void *scene, struct sim_random *random,
                             struct iso_fault *fault) __attribute__((warn_unused_result));

/* Writes the manifest. Call it once, after the last recording. Errors of sim_corpus_write. */
int sim_studio_finish(struct sim_studio *studio, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
