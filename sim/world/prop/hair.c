#include "sim/world/prop/hair.h"

#include <errno.h>
#include <stddef.h>

#include "sim/base/noise3.h"

/* Positions on the MEAN head below are in the head model's own frame (y 62 mm: eyebrows, 145:
 * crown; z 108: forehead, 0: ears, -85: back of the head). */
static const struct iso_vec3 head_centre_mm = {0.0, 35.0, 5.0};
static const struct iso_vec3 model_nose_tip_mm = {0.0, 4.06, 130.69};

enum {
    SPLIT = 3, /* number of parts of each triangle's edge */
    PATCH_VERTICES = (SPLIT + 1) * (SPLIT + 2) / 2,
    PATCH_TRIANGLES = SPLIT * SPLIT,
    CURTAIN_ROWS = 50,
    CURTAIN_COLUMNS = 90,
};

static double ramp_between(double from, double to, double x)
{
    const double f = fmin(fmax((x - from) / (to - from), 0.0), 1.0);
    return f * f * (3.0 - 2.0 * f);
}

/* The shares and ranges in which people differ. */
struct variety {
    double long_share, fringe_share;
    double fringe_most_mm, front_most_rad;
};

static struct sim_hair draw_person(struct sim_random random, struct variety variety)
{
    struct sim_hair hair = {0};
    hair.scalp = sim_random_unit(&random) > 1.0 / 12.0;
    hair.curtain = hair.scalp && sim_random_unit(&random) < variety.long_share;
    hair.thickness_mm = sim_random_between(&random, 5.0, 28.0);
    hair.hairline_mm = 6.0 * sim_random_normal(&random);
    if (sim_random_unit(&random) < variety.fringe_share) {
        hair.hairline_mm += sim_random_between(&random, 15.0, variety.fringe_most_mm);
    }
    hair.curtain_front = sim_random_between(&random, 0.1, variety.front_most_rad);
    hair.key = sim_random_u64(&random);
    return hair;
}

struct sim_hair sim_hair_of_person(uint64_t person_key)
{
    return draw_person(sim_random_seeded(person_key, sim_random_hash("hair"), 0),
                       (struct variety){0.25, 0.2, 35.0, 0.75});
}

struct sim_hair sim_hair_kept(uint64_t person_key)
{
    return draw_person(sim_random_seeded(person_key, sim_random_hash("kept hair"), 0),
                       (struct variety){0.5, 0.5, 50.0, 0.9});
}

/* Changes the hair by the given standard deviations; that of the thickness is a share of it. */
static struct sim_hair draw_day(const struct sim_hair *hair, double thickness, double hairline_mm,
                                double front_rad, struct sim_random *random)
{
    struct sim_hair today = *hair;
    today.thickness_mm *= 1.0 + thickness * fmin(fmax(sim_random_normal(random), -2.0), 2.0);
    today.hairline_mm += hairline_mm * sim_random_normal(random);
    today.curtain_front += front_rad * sim_random_normal(random);
    return today;
}

struct sim_hair sim_hair_of_session(const struct sim_hair *hair, struct sim_random *random)
{
    struct sim_hair today = draw_day(hair, 0.12, 2.5, 0.06, random);
    today.key = sim_random_u64(random);
    return today;
}

struct sim_hair sim_hair_kept_today(const struct sim_hair *hair, struct sim_random *random)
{
    return draw_day(hair, 0.06, 1.5, 0.03, random);
}

/* Approximate distance of a point of the mean head inside the hairline, mm (< 0: bare skin). The
 * line climbs from the top of the ear over the temple to the forehead, and falls behind the ear
 * to the nape. */
static double inside_hairline(const float *p, double hairline_mm)
{
    const double y = p[1], z = p[2];
    double line;
    if (z > 25.0) {
        line = 62.0 + (z - 25.0) * 0.75 - hairline_mm * ramp_between(25.0, 60.0, z);
    } else if (z > -15.0) {
        line = 62.0;
    } else {
        line = fmax(62.0 + (z + 15.0) * 7.0, -50.0);
    }
    return y - line;
}

/* Height of the shell above the skin. Just outside the hairline it is below the skin. */
static double stand_off(const struct sim_hair *hair, double inside_mm, struct iso_vec3 p)
{
    const double bumps = 0.35 * sim_noise3(hair->key, iso_scale(1.0 / 28.0, p)) +
                         0.15 * sim_noise3(hair->key + 1, iso_scale(1.0 / 9.0, p));
    const double strands = 1.2 * sim_noise3(hair->key + 2, iso_scale(1.0 / 4.0, p));
    const double cover = ramp_between(-3.0, 8.0 + 1.2 * hair->thickness_mm, inside_mm);
    return cover * (hair->thickness_mm * (1.0 + bumps) + strands) - 3.0 * (1.0 - cover);
}

struct patch_corner {
    struct iso_vec3 position;
    double inside_mm;
};

/* Lattice point (i, j) of a patch: rows of SPLIT + 1, SPLIT, ... 1 points. */
static uint32_t lattice_index(int i, int j)
{
    return (uint32_t)(i * (SPLIT + 1) - i * (i - 1) / 2 + j);
}

static void build_patch(const struct sim_hair *hair, const struct patch_corner c[3],
                        struct iso_vec3 *vertices, uint32_t (*triangles)[3], uint32_t base)
{
    struct iso_vec3 centre = iso_sub(head_centre_mm, model_nose_tip_mm);
    int n = 0;
    for (int i = 0; i <= SPLIT; i++) {
        for (int j = 0; i + j <= SPLIT; j++) {
            const double w1 = (double)i / SPLIT, w2 = (double)j / SPLIT, w0 = 1.0 - w1 - w2;
            struct iso_vec3 p = iso_madd(iso_madd(iso_scale(w0, c[0].position), w1, c[1].position),
                                         w2, c[2].position);
            const double inside = w0 * c[0].inside_mm + w1 * c[1].inside_mm + w2 * c[2].inside_mm;
            struct iso_vec3 outwards = iso_unit(iso_sub(p, centre));
            vertices[lattice_index(i, j)] = iso_madd(p, stand_off(hair, inside, p), outwards);
            if (i + j < SPLIT) {
                uint32_t upward[3] = {lattice_index(i, j), lattice_index(i + 1, j),
                                      lattice_index(i, j + 1)};
                for (int k = 0; k < 3; k++) {
                    triangles[n][k] = base + upward[k];
                }
                n++;
            }
            if (i + j + 1 < SPLIT) {
                uint32_t downward[3] = {lattice_index(i + 1, j), lattice_index(i + 1, j + 1),
                                        lattice_index(i, j + 1)};
                for (int k = 0; k < 3; k++) {
                    triangles[n][k] = base + downward[k];
                }
                n++;
            }
        }
    }
}

/* Whether a triangle of the head has hair; fills in its corners. */
static bool is_hairy(const struct sim_ict *ict, uint32_t t, const struct iso_vec3 *vertices_mm,
                     const struct sim_hair *hair, struct patch_corner corners[3])
{
    double most = -1e9;
    for (int k = 0; k < 3; k++) {
        const uint32_t v = ict->triangles[t][k];
        if (v >= SIM_ICT_MOUTH_SOCKET) {
            return false;
        }
        corners[k].position = vertices_mm[v];
        corners[k].inside_mm = inside_hairline(ict->mean_mm + 3 * (size_t)v, hair->hairline_mm);
        most = fmax(most, corners[k].inside_mm);
    }
    return most > -3.0;
}

int sim_hair_scalp(const struct sim_ict *ict, const struct iso_vec3 *vertices_mm,
                   const struct sim_hair *hair, struct sim_solid **out)
{
    struct patch_corner corners[3];
    uint32_t n = 0;
    for (uint32_t t = 0; hair->scalp && t < ict->n_triangles; t++) {
        n += is_hairy(ict, t, vertices_mm, hair, corners);
    }
    struct sim_solid *solid;
    const int error = sim_solid_new(n * PATCH_VERTICES, n * PATCH_TRIANGLES, SIM_HAIR, &solid);
    if (error != 0) {
        return error;
    }
    uint32_t patch = 0;
    for (uint32_t t = 0; t < ict->n_triangles; t++) {
        if (is_hairy(ict, t, vertices_mm, hair, corners)) {
            const uint32_t base = patch * PATCH_VERTICES;
            build_patch(hair, corners, solid->vertices_mm + base,
                        solid->triangles + patch * PATCH_TRIANGLES, base);
            patch++;
        }
    }
    *out = solid;
    return 0;
}

/* Half the head's breadth above the ears. */
static double half_breadth(const struct sim_ict *ict, const struct iso_vec3 *vertices_mm)
{
    double widest = 0.0;
    for (uint32_t v = SIM_ICT_HEAD; v < SIM_ICT_MOUTH_SOCKET; v++) {
        if (fabsf(ict->mean_mm[3 * v + 1] - 70.0f) < 20.0f) {
            widest = fmax(widest, fabs(vertices_mm[v].x));
        }
    }
    return widest;
}

/* One point of the curtain. `around` is 0..1 from the subject's right front over the back to the
 * left front, `down` is 0..1 from the top to the lower end. */
static struct iso_vec3 curtain_point(const struct sim_hair *hair, double half_breadth_mm,
                                     double around, double down)
{
    const double reach = 1.5707963 + hair->curtain_front;
    const double angle = reach *
                         (2.0 * around - 1.0); /* 0: back of the head, +-pi/2: beside the ear */
    const double y = 75.0 - 270.0 * down;
    const double side = half_breadth_mm + 9.0 +
                        hair->thickness_mm * 0.7 * ramp_between(0.0, 0.4, down);
    const double depth = 82.0 + 0.5 * hair->thickness_mm;
    struct iso_vec3 p = {side * sin(angle), y, 2.0 - depth * cos(angle)};
    const double bumps = 7.0 *
                             sim_noise3(hair->key + 3, iso_vec3(p.x / 22.0, y / 90.0, p.z / 22.0)) +
                         2.0 * sim_noise3(hair->key + 4, iso_vec3(p.x / 6.0, y / 40.0, p.z / 6.0));
    struct iso_vec3 outwards = iso_unit(iso_vec3(sin(angle), 0.0, -cos(angle)));
    return iso_sub(iso_madd(p, bumps, outwards), model_nose_tip_mm);
}

int sim_hair_curtain(const struct sim_ict *ict, const struct iso_vec3 *vertices_mm,
                     const struct sim_hair *hair, struct sim_solid **out)
{
    if (!hair->curtain) {
        return -EINVAL;
    }
    struct sim_solid *solid;
    const int error = sim_solid_sheet(CURTAIN_ROWS, CURTAIN_COLUMNS, SIM_HAIR, &solid);
    if (error != 0) {
        return error;
    }
    const double half_breadth_mm = half_breadth(ict, vertices_mm);
    for (int r = 0; r < CURTAIN_ROWS; r++) {
        for (int c = 0; c < CURTAIN_COLUMNS; c++) {
            solid->vertices_mm[r * CURTAIN_COLUMNS + c] = curtain_point(
                hair, half_breadth_mm, (double)c / (CURTAIN_COLUMNS - 1),
                (double)r / (CURTAIN_ROWS - 1));
        }
    }
    *out = solid;
    return 0;
}
