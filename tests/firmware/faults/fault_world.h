/* A run of test_faults.c, and the oracle that judges it (fault_oracle.c). The oracle knows the
 * frames that the sensor received and the policy, but not how the appliance decides. */
#ifndef TESTS_FIRMWARE_FAULTS_FAULT_WORLD_H
#define TESTS_FIRMWARE_FAULTS_FAULT_WORLD_H

#include "sim/base/random.h"
#include "tests/firmware/faults/plan.h"
#include "tests/firmware/rigs/rig.h"

enum { STEP_FRAMES = 3, FRAME_MS = 33, SEEN_MAX = 256, LATE_MAX = 128 };

enum actor { NOBODY = 0, ANNA, BOB, CARL, STRANGER, PICTURE, ACTORS };

/* Names of the actors who have one, up to CARL. */
extern const char *const actor_names[ACTORS];

/* A frame with a face that the sensor received undamaged. */
struct sight {
    int64_t t_ns;    /* time of its exposure */
    uint64_t number; /* counted over all frames of the sensor, from 0 */
    enum actor actor;
    bool echo; /* it repeats the previous frame */
};

/* Counts over all seeds. */
struct world_counts {
    int allowed, denied, restarts, absences, acts, by_fault[SIM_FAULTS];
    int lasted[SIM_FAULTS]; /* how many of by_fault lasted for a second and were judged */
    int silences;           /* how often no frame was seen for a second, for any reason */
};

extern struct world_counts total;

/* The oracle's own state. The oracle derives from it what the policy requires. */
struct oracle {
    struct sight seen[SEEN_MAX];
    int n_seen;
    uint64_t fetched; /* number of the first frame that the appliance had not fetched before */
    bool carl_is_enrolled, lockdown, claimed;
    int failures, attacks, locks;
    int64_t locked_until_ns, failed_ns;
    int64_t allowed_ns;           /* time of the last allowed visit */
    int64_t broken_ns;            /* last time at which the disk was broken */
    int64_t sighted_ns;           /* exposure of the last frame that was in time; or the start */
    int64_t since_ns[SIM_FAULTS]; /* beginning of each present fault */
    bool silent, judged[SIM_FAULTS];
};

/* The run of one seed. */
struct world {
    struct rig *rig;
    struct fault_plan plan;
    struct sim_random random;
    struct oracle oracle;
    int step;
    char lockout_path[4096];
    bool running; /* the appliance runs */
    enum actor actor;
    int actor_steps, claim_steps, frames;
    int x_mm; /* position of the face */
    enum actor last_actor;
    int last_x_mm;
    int64_t last_ns; /* time of the last frame that was delivered */
    struct {
        int64_t t_ns;
        enum actor actor;
        int x_mm;
    } late[LATE_MAX];
    int n_late;
};

/* Whether the present step has this fault. */
bool world_is_faulty(const struct world *w, enum sim_fault fault);

/* Fails the test. The message has the seed, the step and the present faults. */
__attribute__((noreturn, format(printf, 2, 3))) void world_broken(const struct world *w,
                                                                  const char *format, ...);

/* Begins a step: notes the faults that begin in it. */
void oracle_begin_step(struct world *w);

/* Notes the frame that was added to the sensor last. It is undamaged and has this actor's face. */
void oracle_see(struct world *w, int64_t t_ns, enum actor actor, bool echo);

/* Returns how many of the sensor's frames the appliance has fetched. */
uint64_t oracle_fetched(const struct world *w);

/* Reads the reports since the last call, and checks the state of the door. */
void oracle_observe(struct world *w);

#endif
