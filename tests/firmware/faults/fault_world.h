/* A run of test_faults.c, and the oracle that judges it (fault_oracle.c): it has seen what the
 * sensor was handed and knows the policy, but nothing of how the appliance decides. */
#ifndef TESTS_FIRMWARE_FAULTS_FAULT_WORLD_H
#define TESTS_FIRMWARE_FAULTS_FAULT_WORLD_H

#include "sim/base/random.h"
#include "tests/firmware/faults/plan.h"
#include "tests/firmware/rigs/rig.h"

enum { STEP_FRAMES = 3, FRAME_MS = 33, SEEN_MAX = 256, LATE_MAX = 128 };

enum actor { NOBODY = 0, ANNA, BOB, CARL, STRANGER, PICTURE, ACTORS };

/* Names of those who have one, up to CARL. */
extern const char *const actor_names[ACTORS];

/* A frame that the sensor was handed whole. */
struct sight {
    int64_t t_ns; /* of its exposure */
    uint64_t number;
    enum actor actor;
    bool echo; /* it repeats the one before */
};

/* What has been counted over all seeds. */
struct world_counts {
    int allowed, denied, restarts, absences, acts, by_fault[SIM_FAULTS];
    int lasted[SIM_FAULTS]; /* of those, how many were judged a second after they began */
    int silences;           /* how often nothing was seen for a second, whatever the reason */
};

extern struct world_counts total;

/* What the policy has to know; kept by the test alone. */
struct oracle {
    struct sight seen[SEEN_MAX];
    int n_seen;
    uint64_t fetched; /* number of the first frame that the appliance had not fetched before */
    bool carl_is_enrolled, lockdown, claimed;
    int failures, attacks, locks;
    int64_t locked_until_ns, failed_ns;
    int64_t allowed_ns;           /* the last visit that was allowed */
    int64_t broken_ns;            /* when the disk was broken last */
    int64_t sighted_ns;           /* when the sensor was last handed a frame that was not late */
    int64_t since_ns[SIM_FAULTS]; /* when each fault began that there is */
    bool silent, judged[SIM_FAULTS];
};

/* One seed's run. */
struct world {
    struct rig *rig;
    struct fault_plan plan;
    struct sim_random random;
    struct oracle oracle;
    int step;
    char lockout_path[4096];
    bool running; /* there is an appliance */
    enum actor actor;
    int actor_steps, claim_steps, frames;
    int x_mm; /* where the face is */
    enum actor last_actor;
    int last_x_mm;
    int64_t last_ns; /* of the frame handed up last */
    struct {
        int64_t t_ns;
        enum actor actor;
        int x_mm;
    } late[LATE_MAX];
    int n_late;
};

/* Whether there is this fault at the present step. */
bool world_is_faulty(const struct world *w, enum sim_fault fault);

/* Fails the test, with seed, step and the faults that there are. */
__attribute__((noreturn, format(printf, 2, 3))) void world_broken(const struct world *w,
                                                                  const char *format, ...);

/* A step begins: takes note of the faults that begin with it. */
void oracle_begin_step(struct world *w);

/* The sensor is handed its next frame: a whole one, with this actor in it. */
void oracle_see(struct world *w, int64_t t_ns, enum actor actor, bool echo);

/* How many of the sensor's frames the appliance has fetched. */
uint64_t oracle_fetched(const struct world *w);

/* Hears what was reported since the last call, and looks at the door. */
void oracle_observe(struct world *w);

#endif
