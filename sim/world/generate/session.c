#include "sim/world/generate/session.h"

#include <stdio.h>
#include <string.h>

#include "sim/world/scene/room.h"

/* Motion of a standing person between frames (33 ms), per axis: a slow drift plus tremor. */
static const double drift_rad = 0.008, drift_mm = 1.5, drift_expression = 0.01;
static const double off_axis_mm = 40.0;
static const double disc_flattening = 0.7;

struct scene {
    struct sim_sitter *sitter;
    struct sim_room *room;        /* or NULL */
    struct sim_sitter *bystander; /* or NULL; stands still */
    struct sim_stance bystander_stance;
    struct sim_stance stance;
    struct iso_vec3 turn_rad, step_mm; /* the session's drift per frame */
    double sway;
    uint32_t n_expression;
    struct sim_random random;
};

static double draw_angle(const struct sim_pose_range *range, struct sim_random *random)
{
    if (range->sd_rad > 0.0) {
        return range->sd_rad * sim_random_normal(random);
    }
    return sim_random_between(random, -range->limit_rad, range->limit_rad);
}

/* Draws yaw and pitch uniformly over the area of the disc, by its radius and angle. */
static void draw_direction(const struct sim_pose_range *range, struct sim_random *random,
                           struct sim_stance *stance)
{
    if (range->disc_rad > 0.0) {
        const double flattening = range->disc_pitch_rad > 0.0
                                      ? range->disc_pitch_rad / range->disc_rad
                                      : disc_flattening;
        const double radius = range->disc_rad * sqrt(sim_random_unit(random));
        const double angle = sim_random_between(random, 0.0, 6.283185307179586);
        stance->yaw_rad = radius * cos(angle);
        stance->pitch_rad = flattening * radius * sin(angle);
    } else {
        stance->yaw_rad = draw_angle(range, random);
        stance->pitch_rad = range->pitch_limit_rad > 0.0
                                ? sim_random_between(random, -range->pitch_limit_rad,
                                                     range->pitch_limit_rad)
                                : draw_angle(range, random);
    }
}

static struct iso_vec3 draw_vector(double sd, struct sim_random *random)
{
    const double x = sd * sim_random_normal(random), y = sd * sim_random_normal(random);
    return iso_vec3(x, y, sd * sim_random_normal(random));
}

static void draw_stance(const struct sim_session_plan *plan, const struct sim_sensor *sensor,
                        struct sim_random *random, struct sim_stance *stance)
{
    const double off_axis = sensor->face_only ? 0.1 * off_axis_mm : off_axis_mm;
    draw_direction(&plan->pose, random, stance);
    stance->yaw_rad += plan->yaw_rad;
    stance->pitch_rad += plan->pitch_rad;
    stance->roll_rad = draw_angle(&plan->pose, random);
    stance->nose_mm.x = sim_random_between(random, -off_axis, off_axis);
    stance->nose_mm.y = sim_random_between(random, -off_axis, off_axis);
    stance->nose_mm.z = plan->far_mm > 0.0 ? sim_random_between(random, plan->near_mm, plan->far_mm)
                                           : sim_random_between(random, sensor->distance_min_mm,
                                                                sensor->distance_max_mm);
    stance->nose_mm = iso_add(stance->nose_mm, plan->offset_mm);
    stance->body_yaw_rad = plan->body_yaw_rad;
}

static void move_on(struct scene *scene)
{
    struct sim_stance *stance = &scene->stance;
    struct iso_vec3 tremor = draw_vector(scene->sway * 0.3 * drift_rad, &scene->random);
    stance->yaw_rad += scene->turn_rad.x + tremor.x;
    stance->pitch_rad += scene->turn_rad.y + tremor.y;
    stance->roll_rad += 0.5 * (scene->turn_rad.z + tremor.z);
    stance->nose_mm = iso_add(stance->nose_mm, scene->step_mm);
    for (uint32_t i = 0; i < scene->n_expression; i++) {
        const double weight = stance->expression[i] * (1.0 + scene->sway * drift_expression *
                                                                 sim_random_normal(&scene->random));
        stance->expression[i] = fmin(weight, 1.0);
    }
}

static int draw_scene(void *context, int frame, struct sim_view *view, struct sim_truth *truth,
                      bool *truth_known)
{
    struct scene *scene = context;
    if (frame > 0) {
        move_on(scene);
    }
    int error = scene->room ? sim_room_draw(scene->room, view) : 0;
    if (error == 0 && scene->bystander) {
        error = sim_sitter_draw(scene->bystander, &scene->bystander_stance, view, NULL);
    }
    if (error == 0) {
        error = sim_sitter_draw(scene->sitter, &scene->stance, view, truth);
    }
    /* The ground truth of a face that looks away is useless. */
    *truth_known = error == 0 && truth->camera_from_face.rotation.m[2][2] < 0.0;
    return error;
}

static double degrees(double angle_rad)
{
    return angle_rad * 57.29577951308232;
}

static struct sim_corpus_row row_of(const struct sim_session_plan *plan,
                                    const struct sim_stance *stance, enum sim_expression drawn)
{
    struct sim_corpus_row row = plan->row;
    if (row.recording[0] == '\0') {
        (void)snprintf(row.recording, sizeof row.recording, "%.40s-%.20s", plan->row.subject,
                       plan->row.session);
    }
    if (strcmp(row.subject, "none") != 0) {
        (void)snprintf(row.pose, sizeof row.pose, "y%+03.0fp%+03.0fr%+03.0f",
                       degrees(stance->yaw_rad), degrees(stance->pitch_rad),
                       degrees(stance->roll_rad));
        (void)snprintf(row.expression, sizeof row.expression, "%s", sim_expression_name(drawn));
    }
    return row;
}

/* Adds a person 0.5 m (or the plan's distance) to 0.9 m behind the visitor, far enough to the side
 * to be visible. */
static int add_bystander(struct scene *scene, const struct sim_ict *ict,
                         const struct sim_session_plan *plan)
{
    struct sim_random *random = &scene->random;
    const struct sim_person anybody = sim_person_draw("bystanders", sim_random_u64(random), 0, 1.0);
    const struct sim_person *other = plan->behind ? plan->behind : &anybody;
    const double min_mm = plan->behind_min_mm > 0.0 ? plan->behind_min_mm : 500.0;
    struct sim_sitter_options options = {.hair = true, .torso = true};
    struct sim_stance *stance = &scene->bystander_stance;
    const double side = sim_random_unit(random) < 0.5 ? -1.0 : 1.0;
    const double x_mm = side * sim_random_between(random, 250.0, 400.0);
    const double y_mm = sim_random_between(random, -120.0, 60.0);
    struct iso_vec3 away = {x_mm, y_mm, sim_random_between(random, min_mm, 900.0)};
    (void)sim_expression_draw(ict, SIM_MILD, random, stance->expression);
    stance->yaw_rad = sim_random_between(random, -0.3, 0.3);
    stance->nose_mm = iso_add(scene->stance.nose_mm, away);
    return sim_sitter_new(ict, other, &options, random, &scene->bystander);
}

static int prepare(struct scene *scene, const struct sim_ict *ict, const struct sim_sensor *sensor,
                   const struct sim_session_plan *plan)
{
    struct sim_sitter_options options = {
        .hair = true, .torso = !sensor->face_only, .keeps_hair = plan->keeps_hair};
    int error = sim_sitter_new(ict, &plan->person, &options, &scene->random, &scene->sitter);
    if (error == 0 && !sensor->face_only && !plan->open_hall) {
        error = sim_room_new(false, &scene->random, &scene->room);
    }
    if (error == 0 && plan->bystander) {
        error = add_bystander(scene, ict, plan);
    }
    scene->sway = plan->sway;
    scene->turn_rad = draw_vector(plan->sway * drift_rad, &scene->random);
    scene->step_mm = draw_vector(plan->sway * drift_mm, &scene->random);
    scene->n_expression = ict->n_expression;
    return error;
}

int sim_session_record(struct sim_studio *studio, const struct sim_ict *ict,
                       const struct sim_sensor *sensor, const struct sim_session_plan *plan,
                       struct iso_fault *fault)
{
    struct scene scene = {.random = plan->random};
    draw_stance(plan, sensor, &scene.random, &scene.stance);
    const enum sim_expression drawn = sim_expression_draw(ict, plan->expression, &scene.random,
                                                          scene.stance.expression);
    struct sim_corpus_row row = row_of(plan, &scene.stance, drawn);
    int error = prepare(&scene, ict, sensor, plan);
    if (error != 0) {
        (void)iso_fault_set(fault, error, "%s: %s", row.recording, strerror(-error));
    } else {
        struct sim_random noise = sim_random_seeded(sim_random_u64(&scene.random), 1, 0);
        error = plan->frozen
                    ? sim_studio_record_frozen(studio, &row, draw_scene, &scene, &noise, fault)
                    : sim_studio_record(studio, &row, draw_scene, &scene, &noise, fault);
    }
    sim_sitter_free(scene.sitter);
    sim_sitter_free(scene.bystander);
    sim_room_free(scene.room);
    return error;
}
