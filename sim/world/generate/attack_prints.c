/* Instruments with the shape of a face: rigid prints of a face or a head. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "sim/world/face/expression.h"
#include "sim/world/generate/attack_scenes.h"
#include "sim/world/prop/face_print.h"
#include "sim/world/prop/hair.h"
#include "sim/world/prop/hand.h"

#define DEGREES(x) ((x)*0.017453292519943295)

/* Face frame of the mean head: where a pole meets the throat of a printed head, and where it meets
 * the inside of a mask behind the chin. */
static const struct iso_vec3 throat_mm = {0.0, -120.0, -110.0}, chin_mm = {0.0, -78.0, -38.0};

/* A print, its original head, and its presentation. */
struct print_scene {
    struct sim_staging *staging;
    struct sim_face_print print;
    struct iso_vec3 *head_mm; /* the target's, face frame */
    struct sim_stance stance;
    struct iso_rigid camera_from_face;
};

static int start(struct print_scene *scene, struct sim_staging *staging)
{
    double weights[SIM_EXPRESSION_SHAPES_MAX];
    *scene = (struct print_scene){.staging = staging};
    scene->head_mm = malloc(staging->ict->n_vertices * sizeof *scene->head_mm);
    if (!scene->head_mm) {
        return -ENOMEM;
    }
    (void)sim_expression_draw(staging->ict, SIM_NEUTRAL, staging->random, weights);
    sim_person_surface(staging->ict, &staging->target, weights, scene->head_mm);
    scene->stance.yaw_rad = sim_staging_yaw(staging, 10.0);
    scene->stance.pitch_rad = sim_staging_pitch(staging, 10.0);
    scene->stance.roll_rad = DEGREES(sim_random_between(staging->random, -5.0, 5.0));
    scene->stance.nose_mm = sim_staging_place(staging);
    scene->camera_from_face = sim_stance_camera_from_face(&scene->stance);
    return 0;
}

/* Adds the target's hair to the scene, in the scale and the material of the print. */
static void add_printed_hair(const struct print_scene *scene)
{
    const struct sim_staging *staging = scene->staging;
    struct sim_hair hair = sim_hair_of_person(staging->target.key);
    if (!hair.scalp) {
        return;
    }
    struct sim_solid *solid = NULL;
    const int made = sim_hair_scalp(staging->ict, scene->head_mm, &hair, &solid);
    for (uint32_t i = 0; made == 0 && i < solid->n_vertices; i++) {
        solid->vertices_mm[i] = iso_scale(scene->print.scale, solid->vertices_mm[i]);
    }
    if (made == 0) {
        solid->material = SIM_PLASTIC;
    }
    sim_group_add(staging->still->things, made, solid);
}

static void add_print(const struct print_scene *scene)
{
    const struct sim_staging *staging = scene->staging;
    struct sim_group *things = staging->still->things;
    struct sim_solid *solid = NULL;
    things->placed = scene->camera_from_face;
    const int made = sim_face_print_new(staging->ict, scene->head_mm, &scene->print, SIM_PLASTIC,
                                        &solid);
    sim_group_add(things, made, solid);
    if (scene->print.whole_head && sim_staging_chance(staging, 0.6)) {
        add_printed_hair(scene);
    }
}

static void put_on_pole(const struct print_scene *scene)
{
    struct iso_vec3 at = iso_scale(scene->print.scale,
                                   scene->print.whole_head ? throat_mm : chin_mm);
    const double radius = scene->print.whole_head ? 16.0 : 8.0;
    sim_staging_add_pole(scene->staging, iso_rigid_apply(&scene->camera_from_face, at), radius);
}

/* A fist holds a printed head at the throat, or a mask by a stick behind the chin. */
static void hold_in_hand(const struct print_scene *scene)
{
    struct sim_group *things = scene->staging->still->things;
    struct iso_vec3 at = iso_scale(scene->print.scale,
                                   scene->print.whole_head ? throat_mm : chin_mm);
    struct iso_vec3 throat = iso_rigid_apply(&scene->camera_from_face, at);
    const bool left = sim_staging_chance(scene->staging, 0.5);
    if (!scene->print.whole_head) {
        put_on_pole(scene);
    }
    things->placed = (struct iso_rigid){iso_mat3_identity(),
                                        iso_add(throat, iso_vec3(0.0, 105.0, 18.0))};
    sim_hand_add(things, SIM_HAND_FIST, left, 0.0, scene->staging->random);
}

static void support(const struct print_scene *scene)
{
    if (sim_staging_chance(scene->staging, 0.5)) {
        put_on_pole(scene);
    } else {
        hold_in_hand(scene);
    }
}

/* Adds a person who wears the print. The face looks in the same direction, *gap_mm behind the
 * print, or farther if nose and chin need more room to stay inside. Sets *gap_mm to the distance.
 */
static int wear(const struct print_scene *scene, double *gap_mm)
{
    struct sim_staging *staging = scene->staging;
    struct sim_person wearer = sim_person_draw("wearers", sim_random_u64(staging->random), 0, 1.0);
    struct sim_sitter_options options = {.hair = true, .torso = true};
    struct sim_still *still = staging->still;
    struct iso_vec3 *face_mm = malloc(staging->ict->n_vertices * sizeof *face_mm);
    if (!face_mm) {
        return -ENOMEM;
    }
    still->stance = scene->stance;
    (void)sim_expression_draw(staging->ict, SIM_NEUTRAL, staging->random, still->stance.expression);
    sim_person_surface(staging->ict, &wearer, still->stance.expression, face_mm);
    const double room = sim_face_print_push(scene->head_mm, face_mm, scene->print.shell_mm + 0.5);
    *gap_mm = fmax(*gap_mm, room);
    still->stance.nose_mm = iso_rigid_apply(&scene->camera_from_face, iso_vec3(0.0, 0.0, -*gap_mm));
    free(face_mm);
    return sim_sitter_new(staging->ict, &wearer, &options, staging->random, &still->person);
}

static int scaled_print(struct sim_staging *staging, double smallest, double largest)
{
    struct print_scene scene;
    const int error = start(&scene, staging);
    if (error != 0) {
        return error;
    }
    scene.print.scale = sim_random_between(staging->random, smallest, largest);
    scene.print.whole_head = sim_staging_chance(staging, 0.6);
    (void)snprintf(staging->variant, sizeof staging->variant, "%s-x%.3f",
                   scene.print.whole_head ? "head" : "face", scene.print.scale);
    add_print(&scene);
    support(&scene);
    free(scene.head_mm);
    return 0;
}

int sim_attack_mask_small(struct sim_staging *staging)
{
    return scaled_print(staging, 0.45, 0.8);
}

int sim_attack_mask_large(struct sim_staging *staging)
{
    return scaled_print(staging, 1.25, 1.6);
}

int sim_attack_mask_still(struct sim_staging *staging)
{
    struct print_scene scene;
    const int error = start(&scene, staging);
    if (error != 0) {
        return error;
    }
    scene.print.scale = 1.0;
    scene.print.whole_head = sim_staging_chance(staging, 0.6);
    (void)snprintf(staging->variant, sizeof staging->variant, "%s",
                   scene.print.whole_head ? "head" : "face");
    add_print(&scene);
    put_on_pole(&scene);
    free(scene.head_mm);
    return 0;
}

int sim_attack_eyes_cut(struct sim_staging *staging)
{
    struct print_scene scene;
    int error = start(&scene, staging);
    if (error != 0) {
        return error;
    }
    scene.print = (struct sim_face_print){.scale = 1.0, .eyes_cut = true, .shell_mm = 2.0};
    scene.print.opening = sim_random_between(staging->random, 1.0, 1.5);
    const bool worn = sim_staging_chance(staging, 0.6);
    double gap_mm = sim_random_between(staging->random, 8.0, 25.0);
    add_print(&scene);
    if (worn) {
        error = wear(&scene, &gap_mm);
        (void)snprintf(staging->variant, sizeof staging->variant, "worn-gap%.0f", gap_mm);
    } else {
        support(&scene);
        (void)snprintf(staging->variant, sizeof staging->variant, "empty");
    }
    free(scene.head_mm);
    return error;
}
