#include "sim/world/generate/stored.h"

#include <stdio.h>
#include <string.h>

#include "sim/world/generate/session.h"
#include "sim/world/prop/solid.h"
#include "sim/world/scene/room.h"

#define DEGREES(x) ((x)*0.017453292519943295)

enum { PEOPLE = 24, STRANGERS = 12, ENROL_FRAMES = 5, VISIT_FRAMES = 3 };

struct stage {
    struct sim_studio *studio;
    const struct sim_ict *ict;
    const struct sim_sensor *sensor;
    uint64_t seed;
    struct iso_fault *fault;
};

struct visit {
    const char *name;
    int number;
    enum sim_expression expression;
    double limit_degrees;
};

static int record_person(const struct stage *stage, const char *subject, int index,
                         const struct visit *visit, enum sim_role role)
{
    struct sim_session_plan plan = {
        .row = {.role = role, .count = role == SIM_ROLE_GALLERY ? ENROL_FRAMES : VISIT_FRAMES},
        .person = sim_person_draw(SIM_POPULATION_STORED, stage->seed, (uint32_t)index, 1.0),
        .expression = visit->expression,
        .pose = {.limit_rad = DEGREES(visit->limit_degrees)},
        .sway = 1.0,
        /* A wall's noise takes most of a frame's bytes, so only every fourth session has a wall. */
        .open_hall = (index + visit->number) % 4 != 0,
    };
    (void)snprintf(plan.row.subject, sizeof plan.row.subject, "%s", subject);
    (void)snprintf(plan.row.session, sizeof plan.row.session, "%s", visit->name);
    plan.random = sim_random_seeded(plan.person.key, sim_random_hash(visit->name), 0);
    return sim_session_record(stage->studio, stage->ict, stage->sensor, &plan, stage->fault);
}

/* Visits are mild, except for every third person's second visit, which is strong. */
static int record_people(const struct stage *stage)
{
    static const struct visit enrol = {"enrol", 0, SIM_NEUTRAL, 5.0},
                              first = {"v1", 1, SIM_MILD, 8.0};
    char subject[8];
    int error = 0;
    for (int i = 0; error == 0 && i < PEOPLE + STRANGERS; i++) {
        const bool stranger = i >= PEOPLE;
        const enum sim_role role = stranger ? SIM_ROLE_IMPOSTOR : SIM_ROLE_PROBE;
        struct visit second = {"v2", 2, i % 3 == 2 ? SIM_STRONG : SIM_MILD, 12.0};
        (void)snprintf(subject, sizeof subject, "%c%02d", stranger ? 'x' : 'p',
                       stranger ? i - PEOPLE + 1 : i + 1);
        if (!stranger) {
            error = record_person(stage, subject, i, &enrol, SIM_ROLE_GALLERY);
        }
        if (error == 0) {
            error = record_person(stage, subject, i, &first, role);
        }
        if (error == 0) {
            error = record_person(stage, subject, i, &second, role);
        }
    }
    return error;
}

/* A person whose face is not usable: turned away, or half out of the picture. */
static int record_useless(const struct stage *stage, const char *note, int index,
                          double body_yaw_rad, struct iso_vec3 offset_mm)
{
    struct sim_session_plan plan = {
        .row = {.subject = "none", .role = SIM_ROLE_IMPOSTOR, .count = VISIT_FRAMES},
        .person = sim_person_draw(SIM_POPULATION_STORED, stage->seed,
                                  (uint32_t)(PEOPLE + STRANGERS + index), 1.0),
        .expression = SIM_NEUTRAL,
        .pose = {.limit_rad = DEGREES(5.0)},
        .sway = 1.0,
        .open_hall = index % 2 == 0,
        .body_yaw_rad = body_yaw_rad,

        .offset_mm = offset_mm,
    };
    (void)snprintf(plan.row.note, sizeof plan.row.note, "%s", note);
    (void)snprintf(plan.row.session, sizeof plan.row.session, "%s%d", note, index);
    plan.random = sim_random_seeded(plan.person.key, sim_random_hash(note), 0);
    return sim_session_record(stage->studio, stage->ict, stage->sensor, &plan, stage->fault);
}

struct still {
    struct sim_room *room;
    struct sim_solid *sheet; /* or NULL */
    struct iso_vec3 scratch_mm[256];
    struct iso_rigid camera_from_sheet;
};

static int draw_still(void *context, int frame, struct sim_view *view, struct sim_truth *truth,
                      bool *truth_known)
{
    struct still *still = context;
    (void)frame;
    (void)truth;
    *truth_known = false;
    int error = sim_room_draw(still->room, view);
    if (error == 0 && still->sheet) {
        /* A hand always moves. */
        still->camera_from_sheet.translation_mm.x += 1.5;
        error = sim_solid_draw(still->sheet, &still->camera_from_sheet, still->scratch_mm, view);
    }
    return error;
}

static int record_still(const struct stage *stage, const char *note, int number,
                        struct still *still, struct sim_random *random)
{
    struct sim_corpus_row row = {
        .subject = "none", .role = SIM_ROLE_IMPOSTOR, .count = VISIT_FRAMES};
    (void)snprintf(row.recording, sizeof row.recording, "none-%s%d", note, number);
    (void)snprintf(row.session, sizeof row.session, "%s%d", note, number);
    (void)snprintf(row.note, sizeof row.note, "%s", note);
    return sim_studio_record(stage->studio, &row, draw_still, still, random, stage->fault);
}

static int record_room(const struct stage *stage, int number, bool furniture)
{
    struct sim_random random = sim_random_seeded(stage->seed, sim_random_hash("room"),
                                                 (uint64_t)number);
    struct still still = {.camera_from_sheet = iso_rigid_identity()};
    int error = sim_room_new(furniture, &random, &still.room);
    if (error == 0) {
        error = record_still(stage, "nobody", number, &still, &random);
    }
    sim_room_free(still.room);
    return error;
}

/* A print of a face, life size, at arm's length from the sensor. */
static int record_photo(const struct stage *stage, int number, double bend_radius_mm,
                        double tilt_rad)
{
    struct sim_random random = sim_random_seeded(stage->seed, sim_random_hash("photo"),
                                                 (uint64_t)number);
    struct still still = {
        .camera_from_sheet = {iso_mat3_rotation(iso_vec3(0.3 * tilt_rad, tilt_rad, 0.0)),
                              {5.0, -10.0, 500.0 + 40.0 * number}}};
    int error = sim_room_new(false, &random, &still.room);
    if (error == 0) {
        error = sim_solid_rectangle(190.0, 260.0, bend_radius_mm, SIM_PAPER, &still.sheet);
    }
    if (error == 0) {
        error = record_still(stage, "photo", number, &still, &random);
    }
    sim_solid_free(still.sheet);
    sim_room_free(still.room);
    return error;
}

static int record_faceless(const struct stage *stage)
{
    int error = record_room(stage, 1, false);
    if (error == 0) {
        error = record_room(stage, 2, true);
    }
    /* The back of the head is some 220 mm from the nose, and the distance is that of the nose. */
    for (int i = 1; error == 0 && i <= 3; i++) {
        error = record_useless(stage, "back", i, DEGREES(180.0), iso_vec3(0.0, 0.0, 220.0));
    }
    /* At 0.5 to 0.75 m half the image is 280 to 420 mm wide. */
    for (int i = 4; error == 0 && i <= 5; i++) {
        const double sideways_mm = i == 4 ? 345.0 : -345.0;
        error = record_useless(stage, "cut", i, 0.0, iso_vec3(sideways_mm, 0.0, 0.0));
    }
    if (error == 0) {
        error = record_photo(stage, 1, 0.0, 0.0);
    }
    if (error == 0) {
        error = record_photo(stage, 2, 0.0, DEGREES(15.0));
    }
    if (error == 0) {
        error = record_photo(stage, 3, 120.0, DEGREES(4.0));
    }
    return error;
}

int sim_stored_count(void)
{
    /* Three recordings of each enrolled person, two of each stranger; rooms, backs, cut faces,
     * photographs. */
    return 3 * PEOPLE + 2 * STRANGERS + 2 + 3 + 2 + 3;
}

int sim_stored_record(struct sim_studio *studio, const struct sim_ict *ict,
                      const struct sim_sensor *sensor, uint64_t seed, struct iso_fault *fault)
{
    struct stage stage = {studio, ict, sensor, seed, fault};
    const int error = record_people(&stage);
    return error == 0 ? record_faceless(&stage) : error;
}
