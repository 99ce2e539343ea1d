#include "tests/firmware/faults/fault_step.h"

/* Removes the frames that the appliance has fetched from the oracle's memory, because the appliance
 * forgets the present visit. Frames that it has not fetched yet stay. */
static void forget_visit(struct oracle *o, uint64_t fetched_now)
{
    int kept = 0;
    for (int i = 0; i < o->n_seen; i++) {
        if (o->seen[i].number >= fetched_now) {
            o->seen[kept++] = o->seen[i];
        }
    }
    o->n_seen = kept;
}

void world_release_claim(struct world *w)
{
    iso_appliance_release(w->rig->appliance);
    w->oracle.claimed = false;
    forget_visit(&w->oracle, oracle_fetched(w));
}

static void claim(struct world *w)
{
    const struct iso_enroll_request carl = {.person = "carl"};
    struct iso_appliance *appliance = w->rig->appliance;
    struct iso_fault fault = {.text = ""};
    if (iso_appliance_claim(appliance)) {
        return;
    }
    int error = 0;
    w->oracle.claimed = true;
    forget_visit(&w->oracle, oracle_fetched(w));
    w->claim_steps = 1 + (int)sim_random_below(&w->random, 30);
    switch (sim_random_below(&w->random, 4)) {
    case 0:
        error = iso_appliance_verify(appliance, "anna", &fault);
        break;
    case 1:
        error = iso_appliance_identify(appliance, &fault);
        break;
    default:
        w->actor = CARL;
        w->actor_steps = w->claim_steps;
        error = iso_appliance_enroll(appliance, &carl, &fault);
        break;
    }
    if (error && !fault.text[0]) {
        world_broken(w, "refused an action without a fault");
    }
}

static void administer(struct world *w)
{
    struct iso_fault fault = {.text = ""};
    const bool on = !w->oracle.lockdown && sim_random_below(&w->random, 4) == 0;
    switch (sim_random_below(&w->random, 3)) {
    case 0:
        if (iso_appliance_remove(w->rig->appliance, "carl", &fault) == 0) {
            w->oracle.carl_is_enrolled = false;
        }
        break;
    case 1:
        if (iso_appliance_lockdown(w->rig->appliance, on, &fault) == 0 || on) {
            w->oracle.lockdown = on;
        }
        break;
    default:
        if (iso_appliance_clear_lockout(w->rig->appliance, &fault) == 0) {
            w->oracle.failures = w->oracle.attacks = w->oracle.locks = 0;
            w->oracle.locked_until_ns = 0;
        }
        break;
    }
    total.acts++;
}

void world_ask(struct world *w)
{
    if (!w->running) {
        return;
    }
    if (w->oracle.claimed && (world_is_faulty(w, SIM_FAULT_BUS_GONE) || w->claim_steps-- <= 0)) {
        world_release_claim(w);
    } else if (!world_is_faulty(w, SIM_FAULT_BUS_GONE) && sim_random_below(&w->random, 25) == 0) {
        if (sim_random_below(&w->random, 2) == 0) {
            claim(w);
        } else {
            administer(w);
        }
    }
}
