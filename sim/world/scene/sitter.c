#include "sim/world/scene/sitter.h"

#include <errno.h>
#include <stdlib.h>

#include "sim/world/face/skin.h"
#include "sim/world/prop/hair.h"
#include "sim/world/prop/solid.h"
#include "sim/world/prop/torso.h"

/* The trunk follows the head by this share of its yaw, about the base of the neck. */
static const double torso_yaw_share = 0.25;
static const struct iso_vec3 neck_base_mm = {0.0, -125.0, -125.0};

enum { SOLIDS_MAX = 3 };

struct sim_sitter {
    const struct sim_ict *ict;
    struct sim_person person;
    struct iso_vec3 *surface_mm; /* [ict->n_vertices], face frame */
    struct iso_vec3 *scratch_mm;
    float *albedo;                      /* [ict->n_triangles] of the skin; NULL: blank */
    struct sim_solid *worn[SOLIDS_MAX]; /* hair, moving with the head */
    struct sim_solid *torso;            /* or NULL */
    int n_worn;
};

/* The person's hair on one day. */
static struct sim_hair hair_today(const struct sim_person *person, bool kept,
                                  struct sim_random *random)
{
    if (kept) {
        const struct sim_hair always = sim_hair_kept(person->key);
        return sim_hair_kept_today(&always, random);
    }
    const struct sim_hair usual = sim_hair_of_person(person->key);
    return sim_hair_of_session(&usual, random);
}

static int put_on_hair(struct sim_sitter *sitter, bool kept, struct sim_random *random)
{
    const struct sim_hair hair = hair_today(&sitter->person, kept, random);
    int error = 0;
    if (hair.scalp) {
        error = sim_hair_scalp(sitter->ict, sitter->surface_mm, &hair,
                               &sitter->worn[sitter->n_worn]);
        sitter->n_worn += error == 0;
    }
    if (error == 0 && hair.curtain) {
        error = sim_hair_curtain(sitter->ict, sitter->surface_mm, &hair,
                                 &sitter->worn[sitter->n_worn]);
        sitter->n_worn += error == 0;
    }
    return error;
}

static uint32_t larger(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

static int allocate_scratch(struct sim_sitter *sitter)
{
    uint32_t most = sitter->ict->n_vertices;
    for (int i = 0; i < sitter->n_worn; i++) {
        most = larger(most, sitter->worn[i]->n_vertices);
    }
    if (sitter->torso) {
        most = larger(most, sitter->torso->n_vertices);
    }
    sitter->scratch_mm = malloc(most * sizeof *sitter->scratch_mm);
    return sitter->scratch_mm ? 0 : -ENOMEM;
}

static int paint_skin(struct sim_sitter *sitter)
{
    sitter->albedo = malloc(sitter->ict->n_triangles * sizeof *sitter->albedo);
    return sitter->albedo ? sim_skin_albedo(sitter->ict, &sitter->person, sitter->albedo) : -ENOMEM;
}

int sim_sitter_new(const struct sim_ict *ict, const struct sim_person *person,
                   const struct sim_sitter_options *options, struct sim_random *random,
                   struct sim_sitter **out)
{
    struct sim_sitter *sitter = calloc(1, sizeof *sitter);
    if (!sitter) {
        return -ENOMEM;
    }
    sitter->ict = ict;
    sitter->person = *person;
    sitter->surface_mm = malloc(ict->n_vertices * sizeof *sitter->surface_mm);
    int error = sitter->surface_mm ? 0 : -ENOMEM;
    if (error == 0) {
        sim_person_surface(ict, person, NULL, sitter->surface_mm);
    }
    if (error == 0 && !options->blank) {
        error = paint_skin(sitter);
    }
    if (error == 0 && options->hair) {
        error = put_on_hair(sitter, options->keeps_hair, random);
    }
    if (error == 0 && options->torso) {
        error = sim_torso_new(sim_random_u64(random), &sitter->torso);
    }
    if (error == 0) {
        error = allocate_scratch(sitter);
    }
    if (error != 0) {
        sim_sitter_free(sitter);
        return error;
    }
    *out = sitter;
    return 0;
}

void sim_sitter_free(struct sim_sitter *sitter)
{
    if (!sitter) {
        return;
    }
    for (int i = 0; i < sitter->n_worn; i++) {
        sim_solid_free(sitter->worn[i]);
    }
    sim_solid_free(sitter->torso);
    free(sitter->surface_mm);
    free(sitter->albedo);
    free(sitter->scratch_mm);
    free(sitter);
}

static struct iso_mat3 camera_rotation(double yaw_rad, double pitch_rad, double roll_rad)
{
    static const struct iso_mat3 frontal = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    struct iso_mat3 pitch = iso_mat3_rotation(iso_vec3(-pitch_rad, 0, 0));
    struct iso_mat3 yaw = iso_mat3_rotation(iso_vec3(0, yaw_rad, 0));
    struct iso_mat3 roll = iso_mat3_rotation(iso_vec3(0, 0, roll_rad));
    struct iso_mat3 head = iso_mat3_mul(&yaw, &pitch);
    head = iso_mat3_mul(&roll, &head);
    return iso_mat3_mul(&frontal, &head);
}

struct iso_rigid sim_stance_camera_from_face(const struct sim_stance *stance)
{
    return (struct iso_rigid){camera_rotation(stance->body_yaw_rad + stance->yaw_rad,
                                              stance->pitch_rad, stance->roll_rad),
                              stance->nose_mm};
}

/* The trunk is upright below the base of the neck, which moves with the head. */
static struct iso_rigid camera_from_torso(const struct sim_stance *stance,
                                          const struct iso_rigid *camera_from_face)
{
    struct iso_rigid pose = {
        camera_rotation(stance->body_yaw_rad + torso_yaw_share * stance->yaw_rad, 0.0, 0.0),
        {0, 0, 0}};
    struct iso_vec3 neck = iso_rigid_apply(camera_from_face, neck_base_mm);
    pose.translation_mm = iso_sub(neck, iso_mat3_apply(&pose.rotation, neck_base_mm));
    return pose;
}

static void note_truth(const struct sim_sitter *sitter, const struct iso_rigid *camera_from_face,
                       struct sim_truth *truth)
{
    truth->camera_from_face = *camera_from_face;
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        truth->ibug_mm[i] = iso_rigid_apply(camera_from_face,
                                            sitter->surface_mm[sitter->ict->landmarks[i]]);
    }
    for (int i = 0; i < ISO_LANDMARKS; i++) {
        truth->landmark_mm[i] = truth->ibug_mm[iso_landmark_ibug[i]];
    }
}

int sim_sitter_draw(struct sim_sitter *sitter, const struct sim_stance *stance,
                    struct sim_view *view, struct sim_truth *truth)
{
    const struct sim_ict *ict = sitter->ict;
    struct iso_rigid camera_from_face = sim_stance_camera_from_face(stance);
    sim_person_surface(ict, &sitter->person, stance->expression, sitter->surface_mm);
    for (uint32_t i = 0; i < ict->n_vertices; i++) {
        sitter->scratch_mm[i] = iso_rigid_apply(&camera_from_face, sitter->surface_mm[i]);
    }
    int error = sim_view_draw(view, sitter->scratch_mm, (const uint32_t(*)[3])ict->triangles,
                              ict->n_triangles, SIM_SKIN);
    if (error == 0 && sitter->albedo) {
        sim_view_paint(view, sitter->albedo, ict->n_triangles);
    }
    for (int i = 0; error == 0 && i < sitter->n_worn; i++) {
        error = sim_solid_draw(sitter->worn[i], &camera_from_face, sitter->scratch_mm, view);
    }
    if (error == 0 && sitter->torso) {
        struct iso_rigid from_torso = camera_from_torso(stance, &camera_from_face);
        error = sim_solid_draw(sitter->torso, &from_torso, sitter->scratch_mm, view);
    }
    if (error == 0 && truth) {
        note_truth(sitter, &camera_from_face, truth);
    }
    return error;
}
