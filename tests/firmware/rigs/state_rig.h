/* The stores of one appliance in a directory of the test. The rig opens them as the daemon does,
 * and plays histories that change them. A failure fails the test. */
#ifndef TESTS_FIRMWARE_RIGS_STATE_RIG_H
#define TESTS_FIRMWARE_RIGS_STATE_RIG_H

#include "drivers/counter/counter.h"
#include "firmware/daemon/components.h"
#include "tests/firmware/rigs/file_mix.h"

/* The time of the stores, and the number of the face that was enrolled last. */
extern int64_t state_rig_now_ns;
extern int state_rig_faces;

/* Opens the counter of the state. Returns 0 or an error. NULL: there is no counter. */
extern int (*state_rig_counter)(struct iso_counter *out, struct iso_fault *fault);

/* Makes the components. None of them is open yet. Returns NULL, with a fault, if the counter cannot
 * be opened. */
struct iso_components *state_rig_new(const char *directory, struct iso_fault *fault);
void state_rig_close(struct iso_components *components);

/* Opens the stores as the daemon does. Returns 0, or the error for which the daemon admits nobody,
 * with a fault. */
int state_rig_try(const char *directory, struct iso_fault *fault);

/* Opens the stores and begins to use the counter. */
struct iso_components *state_rig_open(const char *directory);

void state_rig_append(struct iso_components *components, const char *event);
void state_rig_enrol(struct iso_components *components);

struct state_history {
    const char *name;
    void (*play)(struct iso_components *components);
};

/* Histories, one for each kind of change of the stores. The last one mixes several others. */
extern const struct state_history state_histories[];
extern const size_t state_n_histories;

/* Plays the history of this name on the stores. out: the files of the directory afterwards. */
void state_rig_play(const char *directory, const char *name, struct mix_state *out);

/* Prepares the stores: each of them is written more than once. out: the files afterwards. */
void state_rig_begin(const char *directory, struct mix_state *out);

/* Makes every kind of change on open stores, and closes segments. */
void state_rig_everything(struct iso_components *components);

#endif
