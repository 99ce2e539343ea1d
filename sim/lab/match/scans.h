/* The measured faces of a corpus, for methods other than the appliance's own. */
#ifndef SIM_LAB_MATCH_SCANS_H
#define SIM_LAB_MATCH_SCANS_H

#include "sim/lab/match/acquire.h"
#include "sim/lab/methods/scan.h"

struct sim_scans {
    size_t n_captures, n_samples;
    struct sim_scan **of_capture; /* [n_captures]; NULL: not usable, or already fused */
    struct sim_scan **of_sample;  /* [n_samples], by sim_scans_fuse; NULL: not acquired */
};

/* Allocates for the captures of a corpus. -ENOMEM. */
int sim_scans_new(const struct sim_corpus *corpus, struct sim_scans **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_scans_free(struct sim_scans *faces);

/* Copies the face of a usable frame. It is a function for sim_capture_options.inspect; its context
 * is the struct sim_scans. */
sim_capture_inspector sim_scans_inspect;

/* Reads marked points from landmarks.csv of the recordings (sim/lab/methods/anthroface.h lists
 * their names), then joins the faces of every acquired sample. Errors of reading; -ENOMEM. */
int sim_scans_fuse(const char *directory, const struct sim_corpus *corpus,
                   const struct sim_acquisition *acquisition, struct sim_scans *faces,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* The points that are marked on every sample's face; none if there is no face. */
void sim_scans_marks(const struct sim_scans *faces, bool marks[SIM_MARKS]);

/* Whether there are faces and all their frames had an infrared image. */
bool sim_scans_infrared(const struct sim_scans *faces);

#endif
