#include "tests/firmware/faults/plan.h"

#include <stddef.h>

#include "sim/base/random.h"

enum { BETWEEN_STEPS = 12, LONGEST_STEPS = 30, ALLOCATIONS = 6 };

static const int64_t clock_step_s = 400 * INT64_C(86400);

const char *sim_fault_name(enum sim_fault fault)
{
    static const char *const names[SIM_FAULTS] = {
        "sensor-drop",   "sensor-late", "sensor-twice", "sensor-corrupt", "sensor-frozen",
        "sensor-blank",  "sensor-gone", "clock-step",   "disk-full",      "disk-read-only",
        "database-busy", "bus-gone",    "no-memory",    "restart",
    };
    return (unsigned)fault < SIM_FAULTS ? names[fault] : NULL;
}

static int length_of(enum sim_fault fault, struct sim_random *random)
{
    const int length = 1 + (int)sim_random_below(random, LONGEST_STEPS);
    return fault == SIM_FAULT_CLOCK_STEP || fault == SIM_FAULT_RESTART ? 1 : length;
}

static int64_t value_of(enum sim_fault fault, struct sim_random *random)
{
    switch (fault) {
    case SIM_FAULT_CLOCK_STEP:
        return (int64_t)sim_random_between(random, -(double)clock_step_s, (double)clock_step_s) *
               INT64_C(1000000000);
    case SIM_FAULT_NO_MEMORY:
        return sim_random_below(random, ALLOCATIONS);
    default:
        return 0;
    }
}

struct fault_plan fault_plan_draw(uint64_t seed, int n_steps)
{
    struct sim_random random = sim_random_seeded(seed, sim_random_hash("faults"), 0);
    struct fault_plan plan = {.seed = seed, .n_steps = n_steps};
    int step = 0;
    while (plan.n_events < SIM_FAULT_EVENTS_MAX) {
        step += 1 + (int)sim_random_below(&random, BETWEEN_STEPS);
        if (step >= n_steps) {
            break;
        }
        const enum sim_fault fault = (enum sim_fault)sim_random_below(&random, SIM_FAULTS);
        const int last = step + length_of(fault, &random) - 1;
        const int64_t value = value_of(fault, &random);
        if (!fault_plan_at(&plan, step, fault)) {
            plan.events[plan.n_events++] = (struct sim_fault_event){
                fault, step, last < n_steps ? last : n_steps - 1, value};
        }
    }
    return plan;
}

const struct sim_fault_event *fault_plan_at(const struct fault_plan *plan, int step,
                                            enum sim_fault fault)
{
    for (int i = 0; i < plan->n_events && plan->events[i].first <= step; i++) {
        if (plan->events[i].fault == fault && step <= plan->events[i].last) {
            return &plan->events[i];
        }
    }
    return NULL;
}
