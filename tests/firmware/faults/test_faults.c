/* The appliance while things go wrong: plans of faults (tests/firmware/faults/plan.h), people who
 * come and go, clients who ask for this and that, and an oracle that has seen what the sensor was
 * handed and knows the policy, but nothing of how the appliance decides. It is to hold at all
 * times:
 *
 *   the lock's relay has power only after a visit that the policy allows, for unlock_ms;
 *   a second after a fault began that leaves nothing to see, or to write on, nobody is let in;
 *   a second after the last frame the sensor is known not to see, and the door is at fault;
 *   when all faults are over, who is enrolled gets in, without a restart.
 *
 *   test_firmware_faults [SEEDS [STEPS [FIRST_SEED]]]     a failure names the seed, which does it
 * again */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/faults/fault_tally.h"
#include "tests/firmware/faults/fault_world.h"
#include "tests/firmware/rigs/stores.h"
#include "tests/support/disk/broken_disk.h"
#include "tests/support/memory/scarce_memory.h"
#include "tests/support/scratch.h"

static int n_seeds = 6, n_steps = 500, first_seed = 1;

static const int no_face_of_theirs = 300;
static const int faces[ACTORS] = {[ANNA] = 50, [BOB] = 80, [CARL] = 110, [STRANGER] = 65};

/* ---- the sensor ---- */

static void hand_up(struct world *w, int64_t t_ns, enum actor actor, int x_mm)
{
    const int64_t gap_ns = w->rig->config.decision.gap_ms * ISO_NS_PER_MS;
    const bool echo = actor == w->last_actor && x_mm == w->last_x_mm && t_ns - w->last_ns < gap_ns;
    const enum iso_capture capture = actor == NOBODY    ? ISO_CAPTURE_NOBODY
                                     : actor == PICTURE ? ISO_CAPTURE_FLAT
                                                        : ISO_CAPTURE_OK;
    puppet_sensor_add_at(&w->rig->sensor, t_ns, faces[actor], capture, x_mm);
    w->last_actor = actor;
    w->last_x_mm = x_mm;
    w->last_ns = t_ns;
    if (w->rig->now_ns - t_ns < w->rig->config.sensor.stale_ms * ISO_NS_PER_MS) {
        w->oracle.sighted_ns = t_ns;
    }
    if (faces[actor]) {
        oracle_see(w, t_ns, actor, echo);
    }
}

/* One frame, as the faults of this step would have it. */
static void expose(struct world *w)
{
    const int64_t t_ns = w->rig->now_ns + FRAME_MS * ISO_NS_PER_MS;
    struct puppet_pipeline *pipeline = &w->rig->puppet;
    pipeline->extract_error = 0;
    pipeline->raving = false;
    w->frames++;
    w->oracle.fetched = oracle_fetched(w);
    if (!w->running || strcmp(iso_appliance_status(w->rig->appliance).sensor_state, "lost") == 0) {
        w->n_late = 0;
        return; /* a camera that is not open exposes nothing */
    }
    if (!world_is_faulty(w, SIM_FAULT_SENSOR_FROZEN)) {
        w->x_mm = w->frames % 7; /* nobody stands quite still */
    }
    if (world_is_faulty(w, SIM_FAULT_SENSOR_GONE) || world_is_faulty(w, SIM_FAULT_SENSOR_DROP)) {
        return;
    }
    if (world_is_faulty(w, SIM_FAULT_SENSOR_BLANK)) {
        hand_up(w, t_ns, NOBODY, w->x_mm);
    } else if (world_is_faulty(w, SIM_FAULT_SENSOR_CORRUPT)) {
        /* Some of each kind on end: what is left of a frame before could agree with itself. */
        const int kind = w->frames / 4 % 3;
        pipeline->raving = kind == 0;
        pipeline->extract_error = kind == 1 ? -EDOM : 0;
        puppet_sensor_add_at(&w->rig->sensor, t_ns, no_face_of_theirs,
                             pipeline->raving ? ISO_CAPTURE_OK : ISO_CAPTURE_NOT_A_FACE, w->x_mm);
        w->oracle.sighted_ns = t_ns;
    } else if (world_is_faulty(w, SIM_FAULT_SENSOR_LATE)) {
        w->late[w->n_late].t_ns = t_ns;
        w->late[w->n_late].actor = w->actor;
        w->late[w->n_late++].x_mm = w->x_mm;
    } else {
        for (; w->n_late > 0; w->n_late = 0) {
            for (int i = 0; i < w->n_late; i++) {
                hand_up(w, w->late[i].t_ns, w->late[i].actor, w->late[i].x_mm);
            }
        }
        hand_up(w, t_ns, w->actor, w->x_mm);
        if (world_is_faulty(w, SIM_FAULT_SENSOR_TWICE)) {
            puppet_sensor_add_at(&w->rig->sensor, t_ns, faces[w->actor], ISO_CAPTURE_OK, w->x_mm);
        }
    }
}

/* ---- the appliance, and who ends and begins it ---- */

static void end_appliance(struct world *w)
{
    struct rig *rig = w->rig;
    iso_appliance_stop(rig->appliance);
    iso_appliance_free(rig->appliance);
    iso_audit_close(rig->audit);
    iso_gallery_close(rig->gallery);
    rig->appliance = NULL;
    rig->borrowed.audit = rig->audit = NULL;
    rig->borrowed.gallery = rig->gallery = NULL;
    w->running = false;
    w->oracle.claimed = false;
    w->oracle.n_seen = 0;
    rig->sensor.next = rig->sensor.n_frames; /* what nobody fetched is lost */
    w->last_actor = NOBODY;                  /* nobody remembers the last frame */
    total.restarts++;
    /* What could not be kept is forgotten. */
    if (broken_disk.error || w->rig->now_ns - w->oracle.broken_ns < 3 * ISO_NS_PER_S) {
        struct oracle *o = &w->oracle;
        o->lockdown = false;
        o->failures = o->attacks = o->locks = 0;
        o->locked_until_ns = o->failed_ns = 0;
    }
}

/* As the daemon does; what it cannot do it is asked to do again. */
static void begin_appliance(struct world *w)
{
    struct rig *rig = w->rig;
    struct iso_fault fault = {.text = ""};
    const struct iso_gallery_options gallery = stores_gallery(rig->directory);
    struct iso_audit_options audit = stores_audit(rig->directory);
    audit.sync = false;
    int error = iso_gallery_open(&gallery, &rig->gallery, &fault);
    if (!error) {
        error = iso_audit_open(&audit, &rig->borrowed.times, &rig->audit, &fault);
    }
    rig->borrowed.gallery = rig->gallery;
    rig->borrowed.audit = rig->audit;
    error = error ? error : iso_appliance_new(&rig->borrowed, &rig->appliance);
    error = error ? error : iso_appliance_start(rig->appliance, &fault);
    if (error) {
        if (error == -EBADMSG) {
            world_broken(w, "what was stored is damaged: %s", fault.text);
        }
        iso_appliance_free(rig->appliance);
        iso_audit_close(rig->audit);
        iso_gallery_close(rig->gallery);
        rig->appliance = NULL;
        rig->audit = NULL;
        rig->gallery = NULL;
        total.absences++;
    }
    w->running = error == 0;
    w->oracle.sighted_ns = w->rig->now_ns; /* a camera that is opened has a second to begin */
}

/* Lets the time of a frame pass, with memory as the faults of this step would have it. */
static void run(struct world *w)
{
    const struct sim_fault_event *scarce = fault_plan_at(&w->plan, w->step, SIM_FAULT_NO_MEMORY);
    if (!w->running) {
        w->rig->now_ns += FRAME_MS * ISO_NS_PER_MS;
        w->rig->wall_ns += FRAME_MS * ISO_NS_PER_MS;
        return;
    }
    scarce_memory_left = scarce ? (long)scarce->value : -1;
    rig_run(w->rig, FRAME_MS);
    scarce_memory_left = -1;
}

/* ---- clients ---- */

/* A visit that goes on is forgotten, but for frames that nobody has fetched yet. */
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

static void release(struct world *w)
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
        world_broken(w, "refused without a word");
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

static void ask(struct world *w)
{
    if (!w->running) {
        return;
    }
    if (w->oracle.claimed && (world_is_faulty(w, SIM_FAULT_BUS_GONE) || w->claim_steps-- <= 0)) {
        release(w);
    } else if (!world_is_faulty(w, SIM_FAULT_BUS_GONE) && sim_random_below(&w->random, 25) == 0) {
        if (sim_random_below(&w->random, 2) == 0) {
            claim(w);
        } else {
            administer(w);
        }
    }
}

/* ---- a run ---- */

static void choose_actor(struct world *w)
{
    static const enum actor crowd[] = {NOBODY, NOBODY, NOBODY, ANNA,     ANNA,
                                       ANNA,   BOB,    CARL,   STRANGER, PICTURE};
    if (w->actor_steps-- <= 0) {
        w->actor = crowd[sim_random_below(&w->random, sizeof crowd / sizeof *crowd)];
        w->actor_steps = 2 + (int)sim_random_below(&w->random, 20);
    }
}

/* What holds for the whole of a step. */
static void bring_about(struct world *w)
{
    oracle_begin_step(w);
    const struct sim_fault_event *jump = fault_plan_at(&w->plan, w->step, SIM_FAULT_CLOCK_STEP);
    const bool gone = world_is_faulty(w, SIM_FAULT_SENSOR_GONE);
    w->rig->sensor.wait_error = w->rig->sensor.open_error = gone ? -ENODEV : 0;
    broken_disk.error = world_is_faulty(w, SIM_FAULT_DISK_FULL)        ? ENOSPC
                        : world_is_faulty(w, SIM_FAULT_DISK_READ_ONLY) ? EROFS
                                                                       : 0;
    broken_disk.locked = world_is_faulty(w, SIM_FAULT_DATABASE_BUSY);
    if (broken_disk.error) {
        w->oracle.broken_ns = w->rig->now_ns;
    }
    if (jump) {
        w->rig->wall_ns += jump->value;
    }
    if (w->running && world_is_faulty(w, SIM_FAULT_RESTART)) {
        end_appliance(w);
        oracle_observe(w);
    }
    if (!w->running) {
        begin_appliance(w);
    }
}

static void step(struct world *w)
{
    bring_about(w);
    choose_actor(w);
    ask(w);
    for (int i = 0; i < STEP_FRAMES; i++) {
        expose(w);
        run(w);
        oracle_observe(w);
    }
}

/* All faults are over: what is shut is opened, and anna comes. */
static void recover(struct world *w)
{
    struct iso_fault fault = {.text = ""};
    w->step = w->plan.n_steps;
    w->actor = NOBODY;
    w->actor_steps = 1000;
    w->claim_steps = 0;
    for (int i = 0; i < 30; i++, w->step++) {
        bring_about(w);
        expose(w);
        run(w);
        oracle_observe(w);
    }
    if (!w->running) {
        world_broken(w, "does not begin again");
    }
    release(w);
    rig_run(w->rig, 5000);
    oracle_observe(w);
    assert_int_equal(iso_appliance_lockdown(w->rig->appliance, false, &fault), 0);
    assert_int_equal(iso_appliance_clear_lockout(w->rig->appliance, &fault), 0);
    w->oracle.lockdown = false;
    w->oracle.locked_until_ns = 0;
    w->actor = ANNA;
    for (int i = 0; i < 30 && !rig_relay(w->rig); i++) {
        expose(w);
        run(w);
        oracle_observe(w);
    }
    if (!rig_relay(w->rig)) {
        world_broken(w, "does not recover");
    }
}

/* Shorter times than a door's, so that more happens. */
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
    rig_enrol(rig, "anna", faces[ANNA]);
    const struct iso_template bob = puppet_template(faces[BOB], PUPPET_ALGORITHM);
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
           "%d starts that had to wait\n",
           n_seeds, n_steps, total.allowed, total.denied, total.acts, total.restarts,
           total.absences);
    printf("nothing seen for a second: %d times\n", total.silences);
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
