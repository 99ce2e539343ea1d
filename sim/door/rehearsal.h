/* Runs the appliance in this process on a virtual clock: people are enrolled and come to the
 * door without a daemon, a bus or waiting times. The same corpus gives the same verdicts at the
 * same times on every run, so that automated tests can use it. */
#ifndef SIM_DOOR_REHEARSAL_H
#define SIM_DOOR_REHEARSAL_H

#include "firmware/config/config.h"
#include "sim/door/visit.h"

enum { SIM_LEVELS = ISO_LEVEL_STRICT + 1, SIM_DOORS_MAX = 2 * SIM_LEVELS };

/* "convenient", "balanced", "strict"; NULL outside the range. */
const char *sim_level_name(enum iso_level level);

struct sim_rehearsal_options {
    const char *corpus;          /* directory */
    const char *state;           /* an empty directory for gallery, log and the sensor's slot */
    const char *model, *metric;  /* files */
    double threshold;            /* decision.threshold; NaN: that of the level */
    const enum iso_level *level; /* decision.level; NULL: the configuration's default */
    bool all_levels;             /* run SIM_LEVELS doors side by side, one for each level */
    bool adapt;                  /* match.adapt: the metric adapts to the enrolled people */
    bool adapt_too;       /* with all_levels: SIM_LEVELS more doors, which adapt, beside others */
    bool allow_duplicate; /* also enrol people who look like enrolled ones */
    size_t *not_enrolled; /* NULL: it is an error if a person cannot be enrolled; otherwise counts
                             these people, whose visits are then visits of unknown people */
    const char *visit;    /* after enrolling, play only this recording; NULL: all */
    const char *picture;  /* with `visit` and one door: PNG file of the visit; NULL: none */
};

/* Enrols the subjects of role gallery, in the manifest's order, then plays the other rows, each
 * recording once. *visits has room for all rows of the corpus; *n_visits of them are filled in,
 * with latency by the virtual clock.
 *
 * With all_levels everyone is enrolled at every door, and every visitor stands before all doors at
 * once. Each door decides on its own, exactly as if it were alone, but the template of a frame is
 * computed only once. *visits then has room for SIM_LEVELS times the rows, and the visits of level
 * l begin at visits[l * corpus->n_rows]. The listener is called once for each level, in the order
 * of the levels. Each door has a folder in `state` with the name of its level. With adapt_too,
 * *visits has room for SIM_DOORS_MAX times the rows, the doors that adapt come after the others,
 * and their folders end in "-adapted". After each enrolment a door that adapts waits for its
 * metric.
 *
 * Errors of iso_components_open, the appliance and the slot; -ENOMSG if a person cannot be
 * enrolled; -ETIMEDOUT if a door does not lock again; -ENOENT if no row other than an enrolment
 * has the recording `visit`; errors of drawing the picture. */
int sim_rehearse(const struct sim_rehearsal_options *options, const struct sim_corpus *corpus,
                 sim_visit_listener *listener, void *context, struct sim_visit *visits,
                 size_t *n_visits, struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
