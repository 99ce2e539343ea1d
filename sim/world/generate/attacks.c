#include "sim/world/generate/attacks.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "sim/world/generate/attack_scenes.h"
#include "sim/world/generate/session.h"

#define DEGREES(x) ((x)*0.017453292519943295)

/* A session's usual motion, some 45 mm/s and 14 degrees/s on each axis, is that of a person who
 * shifts from foot to foot. A person who looks at a door stands more still. Assumed here: the
 * motion is as little as a tenth of that. The centre of pressure of people who stand quietly moves
 * at the order of 10 mm/s (Prieto et al., "Measures of postural steadiness", IEEE Trans. Biomedical
 * Engineering 43, 1996). */
static const double sway_least = 0.1;

struct stage {
    struct sim_studio *studio;
    const struct sim_ict *ict;
    const struct sim_sensor *sensor;
    const struct sim_attacks_plan *plan;
    struct iso_fault *fault;
};

static const struct sim_staged_kind kinds[] = {
    {"photo-flat", sim_attack_photo_flat, false, false},
    {"photo-bent", sim_attack_photo_bent, false, false},
    {"screen", sim_attack_screen, false, false},
    {"mask-small", sim_attack_mask_small, false, false},
    {"mask-large", sim_attack_mask_large, false, false},
    {"print-eyes-cut", sim_attack_eyes_cut, false, false},
    {"mask-still", sim_attack_mask_still, true, false},
};

static struct sim_session_plan person_plan(const struct stage *stage, int person, const char *kind,
                                           int number)
{
    const struct sim_attacks_plan *plan = stage->plan;
    struct sim_session_plan session = {
        .row = {.role = SIM_ROLE_PROBE, .count = 1},
        .person = sim_person_draw(plan->population, plan->seed, (uint32_t)person,
                                  plan->identity_variance),
        .expression = SIM_MILD,
        .pose = {.limit_rad = DEGREES(10.0)},
        .sway = 1.0,
    };
    (void)snprintf(session.row.subject, sizeof session.row.subject, "p%04d", person);
    (void)snprintf(session.row.note, sizeof session.row.note, "%s-%" PRIu64, plan->population,
                   plan->seed);
    session.random = sim_random_seeded(session.person.key, sim_random_hash(kind), (uint64_t)number);
    return session;
}

static int record_session(const struct stage *stage, const struct sim_session_plan *plan)
{
    return sim_session_record(stage->studio, stage->ict, stage->sensor, plan, stage->fault);
}

static int record_enrolled(const struct stage *stage, int person)
{
    struct sim_session_plan session = person_plan(stage, person, "attacks-enrol", 0);
    session.row.role = SIM_ROLE_GALLERY;
    session.expression = SIM_NEUTRAL;
    session.pose = (struct sim_pose_range){.sd_rad = DEGREES(3.0)};
    (void)snprintf(session.row.session, sizeof session.row.session, "s0");
    return record_session(stage, &session);
}

/* Records an enrolled person for one frame or, if `lasting`, for a visit of several frames. */
static int record_bona_fide(const struct stage *stage, int number, bool lasting)
{
    const int person = number % stage->plan->n_people;
    const char *kind = lasting ? "attacks-visit" : "attacks-glance";
    struct sim_session_plan session = person_plan(stage, person, kind, number);
    if (number % 3 == 2) {
        session.expression = SIM_STRONG;
        session.pose.limit_rad = DEGREES(15.0);
    }
    if (lasting) {
        const double luck = sim_random_unit(&session.random);
        session.sway = pow(sway_least, luck);
        session.row.count = (size_t)stage->plan->frames;
    }
    (void)snprintf(session.row.session, sizeof session.row.session, "%s%d", lasting ? "v" : "g",
                   number / stage->plan->n_people + 1);
    const size_t origin = strlen(session.row.note);
    (void)snprintf(session.row.note + origin, sizeof session.row.note - origin, " bona-fide");
    return record_session(stage, &session);
}

static int record_frozen(const struct stage *stage, int number)
{
    struct sim_session_plan session = person_plan(stage, number % stage->plan->n_people,
                                                  "attacks-frozen", number);
    session.frozen = true;
    session.row.role = SIM_ROLE_IMPOSTOR;
    session.row.count = (size_t)stage->plan->frames;
    (void)snprintf(session.row.subject, sizeof session.row.subject, "none");
    (void)snprintf(session.row.session, sizeof session.row.session, "frozen-%04d", number);
    (void)snprintf(session.row.note, sizeof session.row.note, "frozen");
    return record_session(stage, &session);
}

static int record_attack(const struct stage *stage, const struct sim_staged_kind *kind, int number)
{
    const struct sim_attacks_plan *plan = stage->plan;
    struct sim_staging_plan staging = {.ict = stage->ict,
                                       .sensor = stage->sensor,
                                       .role = SIM_ROLE_IMPOSTOR,
                                       .seed = plan->seed,
                                       .frames = plan->frames,
                                       .turn = plan->turn};
    struct sim_person target = sim_person_draw(
        plan->population, plan->seed, (uint32_t)(number % plan->n_people), plan->identity_variance);
    return sim_staging_record(stage->studio, &staging, kind, number, &target, stage->fault);
}

int sim_attacks_count(const struct sim_attacks_plan *plan)
{
    /* All enrolled people, then each kind; living people count as two kinds, frozen frames as one.
     */
    const int n_kinds = (int)(sizeof kinds / sizeof *kinds) + 3;
    return plan->n_people + n_kinds * plan->per_kind;
}

int sim_attacks_record(struct sim_studio *studio, const struct sim_ict *ict,
                       const struct sim_sensor *sensor, const struct sim_attacks_plan *plan,
                       struct iso_fault *fault)
{
    struct stage stage = {studio, ict, sensor, plan, fault};
    int error = 0;
    for (int i = 0; error == 0 && i < plan->n_people; i++) {
        error = record_enrolled(&stage, i);
    }
    for (int i = 0; error == 0 && i < 2 * plan->per_kind; i++) {
        error = record_bona_fide(&stage, i / 2, i % 2 != 0);
    }
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        for (int i = 0; error == 0 && i < plan->per_kind; i++) {
            error = record_attack(&stage, &kinds[k], i);
        }
    }
    for (int i = 0; error == 0 && i < plan->per_kind; i++) {
        error = record_frozen(&stage, i);
    }
    return error;
}
