/* The appliance while faults are present. The test plays plans of faults
 * (tests/firmware/faults/plan.h), people who come and go, and clients who make calls. An oracle
 * judges the appliance: it knows the frames that the sensor received and the policy, but not how
 * the appliance decides. These rules hold at all times:
 *
 *   The relay of the lock has power only after a visit that the policy allows, for unlock_ms.
 *   A fault may take away the frames, or the place for records: a second later nobody is admitted.
 *   A second after the last frame the sensor is reported as blind, and the door is at fault.
 *   When all faults are over, enrolled people are admitted without a restart.
 *
 * usage: test_firmware_faults [SEEDS [STEPS [FIRST_SEED]]]
 *
 * A failure names its seed; a run with this seed repeats it. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/faults/fault_step.h"
#include "tests/firmware/faults/fault_tally.h"
#include "tests/support/disk/broken_disk.h"
#include "tests/support/scratch.h"

static int n_seeds = 6, n_steps = 500, first_seed = 1;

static void choose_actor(struct world *w)
{
    static const enum actor crowd[] = {NOBODY, NOBODY, NOBODY, ANNA,     ANNA,
                                       ANNA,   BOB,    CARL,   STRANGER, PICTURE};
    if (w->actor_steps-- <= 0) {
        w->actor = crowd[sim_random_below(&w->random, sizeof crowd / sizeof *crowd)];
        w->actor_steps = 2 + (int)sim_random_below(&w->random, 20);
    }
}

/* Begins a step: sets the state of sensor, disk and clock that the step's faults require, and ends
 * or starts the appliance. */
static void bring_about(struct world *w)
{
    oracle_begin_step(w);
    const struct sim_fault_event *jump = fault_plan_at(&w->plan, w->step, SIM_FAULT_CLOCK_STEP);
    const bool gone = world_is_faulty(w, SIM_FAULT_SENSOR_GONE);
    w->rig->sensor.wait_error = w->rig->sensor.open_error = gone ? -ENODEV : 0;
    broken_disk.error = world_is_faulty(w, SIM_FAULT_DISK_READ_ONLY) ? EROFS : 0;
    if (world_is_faulty(w, SIM_FAULT_DISK_FULL)) {
        broken_disk.error = ENOSPC;
    }
    broken_disk.locked = world_is_faulty(w, SIM_FAULT_DATABASE_BUSY);
    if (broken_disk.error) {
        w->oracle.broken_ns = w->rig->now_ns;
    }
    if (jump) {
        w->rig->wall_ns += jump->value;
    }
    if (w->running && world_is_faulty(w, SIM_FAULT_RESTART)) {
        world_end_appliance(w);
        oracle_observe(w);
    }
    if (!w->running) {
        world_begin_appliance(w);
    }
}

static void step(struct world *w)
{
    bring_about(w);
    choose_actor(w);
    world_ask(w);
    for (int i = 0; i < STEP_FRAMES; i++) {
        world_expose(w);
        world_pass_frame(w);
        oracle_observe(w);
    }
}

/* Checks that the appliance works again when all faults are over: a lockdown and a lock-out are
 * lifted, anna comes, and the door opens. */
static void recover(struct world *w)
{
    struct iso_fault fault = {.text = ""};
    w->step = w->plan.n_steps;
    w->actor = NOBODY;
    w->actor_steps = 1000;
    w->claim_steps = 0;
    for (int i = 0; i < 30; i++, w->step++) {
        bring_about(w);
        world_expose(w);
        world_pass_frame(w);
        oracle_observe(w);
    }
    if (!w->running) {
        world_broken(w, "the appliance does not start again");
    }
    world_release_claim(w);
    rig_run(w->rig, 5000);
    oracle_observe(w);
    assert_int_equal(iso_appliance_lockdown(w->rig->appliance, false, &fault), 0);
    assert_int_equal(iso_appliance_clear_lockout(w->rig->appliance, &fault), 0);
    w->oracle.lockdown = false;
    w->oracle.locked_until_ns = 0;
    w->actor = ANNA;
    for (int i = 0; i < 30 && !rig_relay(w->rig); i++) {
        world_expose(w);
        world_pass_frame(w);
        oracle_observe(w);
    }
    if (!rig_relay(w->rig)) {
        world_broken(w, "does not recover");
    }
}

/* The times are shorter than those of a real door, so that more happens in a run. */
static void configure(struct iso_config *config)
{
    config->motion.frozen_frames = 3;
    config->decision.gap_ms = 500;
    config->decision.refractory_ms = 1000;
    config->door.unlock_ms = 1000;
    config->sensor.silence_ms = 2000;
    config->sensor.stale_ms = 500;
    config->sensor.retry_ms = 100;
    config->sensor.retry_max_ms = 500;
    config->lockout = (struct iso_config_lockout){
        .failures = 4, .attacks = 3, .first_ms = 3000, .longest_ms = 10000, .forget_ms = 20000};
}

static void play(int seed)
{
    void *state = NULL;
    static struct world w;
    w = (struct world){.plan = fault_plan_draw((uint64_t)seed, n_steps), .running = true};
    assert_int_equal(rig_setup(&state), 0);
    struct rig *rig = w.rig = state;
    w.random = sim_random_seeded((uint64_t)seed, sim_random_hash("people"), 0);
    configure(&rig->config);
    rig->sensor.streams = true;
    rig_enrol(rig, "anna", actor_faces[ANNA]);
    const struct iso_template bob = puppet_template(actor_faces[BOB], PUPPET_ALGORITHM);
    const struct iso_person entry = {.name = "bob",
                                     .enrolled_s = 1,
                                     .valid_from_s = 1795250000 - 86400,
                                     .valid_until_s = 1795250000 + 86400};
    assert_int_equal(iso_gallery_add(rig->gallery, &entry, &bob, NULL), 0);
    (void)snprintf(w.lockout_path, sizeof w.lockout_path, "%s",
                   scratch_path(rig->directory, "lockout"));
    rig->borrowed.lockout_path = w.lockout_path;
    iso_appliance_free(rig->appliance);
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    rig_start(rig);
    w.oracle.sighted_ns = rig->now_ns;
    for (w.step = 0; w.step < n_steps; w.step++) {
        step(&w);
    }
    recover(&w);
    for (int i = 0; i < w.plan.n_events; i++) {
        total.by_fault[w.plan.events[i].fault]++;
    }
    state = rig;
    assert_int_equal(rig_teardown(&state), 0);
}

static void nobody_is_let_in_who_should_not_be(void **state)
{
    (void)state;
    for (int i = 0; i < n_seeds; i++) {
        play(first_seed + i);
    }
    printf("%d seeds x %d steps: %d visits allowed, %d denied, %d acts, %d restarts, "
           "%d starts failed\n",
           n_seeds, n_steps, total.allowed, total.denied, total.acts, total.restarts,
           total.absences);
    printf("no frame in time for a second: %d times\n", total.silences);
    for (int i = 0; i < SIM_FAULTS; i++) {
        printf("  %-15s %4d, %4d for a second or longer\n", sim_fault_name((enum sim_fault)i),
               total.by_fault[i], total.lasted[i]);
    }
    assert_true(total.allowed > 2 * n_seeds && total.denied > n_seeds && total.silences > n_seeds);
}

static void a_seed_makes_the_same_plan(void **state)
{
    (void)state;
    const struct fault_plan one = fault_plan_draw(7, 500), same = fault_plan_draw(7, 500);
    const struct fault_plan other = fault_plan_draw(8, 500);
    assert_memory_equal(one.events, same.events, (size_t)one.n_events * sizeof *one.events);
    assert_int_equal(one.n_events, same.n_events);
    assert_true(one.n_events > 40);
    assert_memory_not_equal(one.events, other.events, sizeof *one.events);
    for (int i = 0; i < one.n_events; i++) {
        const struct sim_fault_event *event = &one.events[i];
        assert_true(event->first <= event->last && event->last < 500);
        assert_ptr_equal(fault_plan_at(&one, event->last, event->fault), event);
    }
}

int main(int argc, char **argv)
{
    n_seeds = argc > 1 ? atoi(argv[1]) : n_seeds;
    n_steps = argc > 2 ? atoi(argv[2]) : n_steps;
    first_seed = argc > 3 ? atoi(argv[3]) : first_seed;
    broken_disk_install();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_seed_makes_the_same_plan),
        cmocka_unit_test(nobody_is_let_in_who_should_not_be),
    };
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    long faults = 0;
    for (int i = 0; i < SIM_FAULTS; i++) {
        faults += total.by_fault[i];
    }
    fault_tally_print("drill", faults, total.allowed + total.denied + total.acts, failed);
    return failed;
}
