#include "sim/world/generate/staging.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct iso_vec3 sim_staging_place(const struct sim_staging *staging)
{
    const double x = sim_random_between(staging->random, -40.0, 40.0);
    const double y = sim_random_between(staging->random, -40.0, 40.0);
    return iso_vec3(x, y,
                    sim_random_between(staging->random, staging->sensor->distance_min_mm,
                                       staging->sensor->distance_max_mm));
}

static double rad_of_degrees(double degrees)
{
    return degrees * 0.017453292519943295;
}

double sim_staging_yaw(const struct sim_staging *staging, double limit_deg)
{
    const struct sim_turn *turn = &staging->turn;
    if (!turn->away) {
        return rad_of_degrees(sim_random_between(staging->random, -limit_deg, limit_deg));
    }
    const double luck = sim_random_between(staging->random, -1.0, 1.0);
    const double range_deg = turn->yaw_most_deg - turn->yaw_least_deg;
    return rad_of_degrees(copysign(turn->yaw_least_deg + fabs(luck) * range_deg, luck));
}

double sim_staging_pitch(const struct sim_staging *staging, double limit_deg)
{
    const double most_deg = staging->turn.away ? staging->turn.pitch_most_deg : limit_deg;
    return rad_of_degrees(sim_random_between(staging->random, -most_deg, most_deg));
}

bool sim_staging_chance(const struct sim_staging *staging, double share)
{
    return sim_random_unit(staging->random) < share;
}

void sim_staging_add_pole(struct sim_staging *staging, struct iso_vec3 top_mm, double radius_mm)
{
    struct sim_group *things = staging->still->things;
    struct sim_joint joints[2] = {{top_mm, radius_mm},
                                  {iso_add(top_mm, iso_vec3(0.0, 900.0, 20.0)), radius_mm}};
    things->placed = iso_rigid_identity();
    sim_group_add_tube(things, joints, 2, SIM_PLASTIC);
}

static int record_scene(struct sim_studio *studio, const struct sim_staging_plan *plan,
                        const struct sim_staged_kind *kind, int number,
                        const struct sim_staging *staging, struct iso_fault *fault)
{
    struct sim_corpus_row row = {.subject = "none", .role = plan->role, .count = 1};
    if (kind->lasting) {
        row.count = (size_t)plan->frames;
    }
    (void)snprintf(row.recording, sizeof row.recording, "none-%s-%04d", kind->name, number);
    (void)snprintf(row.session, sizeof row.session, "%s-%04d", kind->name, number);
    (void)snprintf(row.expression, sizeof row.expression, "%s", staging->variant);
    (void)snprintf(row.note, sizeof row.note, "%s", kind->name);
    struct sim_random noise = sim_random_seeded(sim_random_u64(staging->random), 1, 0);
    return sim_studio_record(studio, &row, sim_still_draw, staging->still, &noise, fault);
}

int sim_staging_record(struct sim_studio *studio, const struct sim_staging_plan *plan,
                       const struct sim_staged_kind *kind, int number,
                       const struct sim_person *target, struct iso_fault *fault)
{
    struct sim_random random = sim_random_seeded(plan->seed, sim_random_hash(kind->name),
                                                 (uint64_t)number);
    struct sim_still still = {0};
    struct sim_staging staging = {.ict = plan->ict,
                                  .sensor = plan->sensor,
                                  .turn = plan->turn,
                                  .random = &random,
                                  .still = &still};
    staging.target = target ? *target : sim_person_mean();
    int error = sim_still_init(&still, !kind->bare, &random);
    if (error == 0) {
        error = kind->build(&staging);
    }
    if (error == 0) {
        error = still.things->error;
    }
    if (error != 0) {
        (void)iso_fault_set(fault, error, "%s %d: cannot be made: %s", kind->name, number,
                            strerror(-error));
    } else {
        error = record_scene(studio, plan, kind, number, &staging, fault);
    }
    sim_still_done(&still);
    return error;
}
