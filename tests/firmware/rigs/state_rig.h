/* The stores of one appliance in a test's directory, opened as the daemon opens them, and histories
 * that change them. A failure fails the test. */
#ifndef TESTS_FIRMWARE_RIGS_STATE_RIG_H
#define TESTS_FIRMWARE_RIGS_STATE_RIG_H

#include "drivers/counter/counter.h"
#include "firmware/daemon/components.h"
#include "tests/firmware/rigs/file_mix.h"

/* The times of the stores, and the number of the face that was enrolled last. */
extern int64_t state_rig_now_ns;
extern int state_rig_faces;

/* Who opens the counter of the state; 0 or its error. NULL: there is none. */
extern int (*state_rig_counter)(struct iso_counter *out, struct iso_fault *fault);

/* Nothing is open yet. */
struct iso_components *state_rig_new(const char *directory, struct iso_fault *fault);
void state_rig_close(struct iso_components *components);

/* As the daemon does: 0, or why nobody is let in, with a fault. */
int state_rig_try(const char *directory, struct iso_fault *fault);

/* Opens them, and begins to count. */
struct iso_components *state_rig_open(const char *directory);

void state_rig_append(struct iso_components *components, const char *event);
void state_rig_enrol(struct iso_components *components);

struct state_history {
    const char *name;
    void (*play)(struct iso_components *components);
};

/* Everything that changes the stores, a kind each; the last is all of it. */
extern const struct state_history state_histories[];
extern const size_t state_n_histories;

/* Plays a history of this name on the stores; out: what the directory holds then. */
void state_rig_play(const char *directory, const char *name, struct mix_state *out);

/* A life before: every store has been written, and more than once. */
void state_rig_begin(const char *directory, struct mix_state *out);

/* Everything, and closed segments, on open stores. */
void state_rig_everything(struct iso_components *components);

#endif
