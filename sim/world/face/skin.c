#include "sim/world/face/skin.h"

#include <errno.h>
#include <stdlib.h>

#include "sim/base/random.h"

/* Inner parts: hardly any light leaves them. */
static const double mouth_socket = 0.12, eye_socket = 0.3, pupil = 0.04, sclera = 0.5;
/* Angles seen from the middle of the eyeball (radius 12 mm): radii of 5.9 and 2 mm. */
static const double iris_rad = 0.51, pupil_rad = 0.17;
/* Half widths of the curves, and the widths over which they fade, mm. */
static const double lash_mm = 1.0, lid_mm = 5.0, lip_mm = 3.2, nostril_mm = 2.5, fade_mm = 2.0;
/* The model's landmarks of the brows run along their upper edge. In real infrared images the
 * darkest line is this far below it (median of 7 people). */
static const double brow_below_mm = 6.0;

struct skin {
    double skin, brow, lip, lid, lash, iris, nostril;
    double brow_mm; /* half width */
};

static struct skin skin_of(const struct sim_person *person)
{
    struct sim_random random = sim_random_seeded(person->key, sim_random_hash("skin"), 0);
    struct skin skin = {0};
    skin.skin = sim_random_between(&random, 0.5, 0.65);
    skin.brow = sim_random_between(&random, 0.15, 0.35);
    skin.lip = skin.skin * sim_random_between(&random, 0.72, 0.9);
    skin.lid = skin.skin * sim_random_between(&random, 0.75, 0.95);
    skin.lash = sim_random_between(&random, 0.2, 0.35);
    skin.iris = sim_random_between(&random, 0.2, 0.35);
    skin.nostril = 0.15;
    skin.brow_mm = sim_random_between(&random, 2.5, 4.5);
    return skin;
}

static struct iso_vec3 mean_vertex(const struct sim_ict *ict, uint32_t v)
{
    const float *p = ict->mean_mm + 3 * (size_t)v;
    return iso_vec3((double)p[0], (double)p[1], (double)p[2]);
}

static double distance_to_segment(struct iso_vec3 p, struct iso_vec3 a, struct iso_vec3 b)
{
    struct iso_vec3 ab = iso_sub(b, a), ap = iso_sub(p, a);
    const double along = fmin(fmax(iso_dot(ap, ab) / iso_dot(ab, ab), 0.0), 1.0);
    return iso_norm(iso_madd(ap, -along, ab));
}

/* Distance from p to the polyline through landmarks first..last, closed or open. */
static double distance_to_curve(const struct sim_ict *ict, struct iso_vec3 p, int first, int last,
                                bool closed)
{
    double least = 1e9;
    for (int k = first; k < last + (closed ? 1 : 0); k++) {
        struct iso_vec3 a = mean_vertex(ict, ict->landmarks[k]);
        struct iso_vec3 b = mean_vertex(ict, ict->landmarks[k == last ? first : k + 1]);
        least = fmin(least, distance_to_segment(p, a, b));
    }
    return least;
}

/* 1 within half_mm of a curve, 0 from fade_mm further on. */
static double on_curve(double distance_mm, double half_mm)
{
    const double f = fmin(fmax((half_mm + fade_mm - distance_mm) / fade_mm, 0.0), 1.0);
    return f * f * (3.0 - 2.0 * f);
}

static double towards(double albedo, double other, double share)
{
    return albedo + share * (other - albedo);
}

static double face_albedo(const struct sim_ict *ict, const struct skin *skin, struct iso_vec3 p)
{
    struct iso_vec3 above = iso_add(p, iso_vec3(0.0, brow_below_mm, 0.0));
    const double brow = fmin(distance_to_curve(ict, above, 17, 21, false),
                             distance_to_curve(ict, above, 22, 26, false));
    const double lash = fmin(distance_to_curve(ict, p, 36, 41, true),
                             distance_to_curve(ict, p, 42, 47, true));
    const double lip = fmin(distance_to_curve(ict, p, 48, 59, true),
                            distance_to_curve(ict, p, 60, 67, true));
    const double nostril = distance_to_curve(ict, p, 32, 34, false);
    double albedo = towards(skin->skin, skin->lid, on_curve(lash, lid_mm));
    albedo = towards(albedo, skin->brow, on_curve(brow, skin->brow_mm));
    albedo = towards(albedo, skin->lip, on_curve(lip, lip_mm));
    albedo = towards(albedo, skin->nostril, 0.5 * on_curve(nostril, nostril_mm));
    return towards(albedo, skin->lash, on_curve(lash, lash_mm));
}

/* The middles of the eyeballs, by the sign of x: [0] the subject's right. */
static void eye_middles(const struct sim_ict *ict, struct iso_vec3 middle[2])
{
    int n[2] = {0, 0};
    middle[0] = middle[1] = iso_vec3(0.0, 0.0, 0.0);
    for (uint32_t v = SIM_ICT_EYEBALLS; v < ict->n_vertices; v++) {
        struct iso_vec3 p = mean_vertex(ict, v);
        int side = p.x > 0.0;
        middle[side] = iso_add(middle[side], p);
        n[side]++;
    }
    for (int side = 0; side < 2; side++) {
        middle[side] = iso_scale(n[side] > 0 ? 1.0 / n[side] : 0.0, middle[side]);
    }
}

static double eye_albedo(const struct skin *skin, struct iso_vec3 p,
                         const struct iso_vec3 middle[2])
{
    struct iso_vec3 d = iso_unit(iso_sub(p, middle[p.x > 0.0]));
    const double angle = acos(fmin(fmax(d.z, -1.0), 1.0));
    if (angle < pupil_rad) {
        return pupil;
    }
    return angle < iris_rad ? skin->iris : sclera;
}

static double vertex_albedo(const struct sim_ict *ict, const struct skin *skin,
                            const struct iso_vec3 middle[2], uint32_t v)
{
    if (v < SIM_ICT_HEAD) {
        return face_albedo(ict, skin, mean_vertex(ict, v));
    }
    if (v < SIM_ICT_MOUTH_SOCKET) {
        return skin->skin;
    }
    if (v < SIM_ICT_EYE_SOCKETS) {
        return mouth_socket;
    }
    return v < SIM_ICT_EYEBALLS ? eye_socket : eye_albedo(skin, mean_vertex(ict, v), middle);
}

int sim_skin_albedo(const struct sim_ict *ict, const struct sim_person *person, float *facet_albedo)
{
    double *albedo = malloc(ict->n_vertices * sizeof *albedo);
    struct skin skin = skin_of(person);
    struct iso_vec3 middle[2];
    if (!albedo) {
        return -ENOMEM;
    }
    eye_middles(ict, middle);
    for (uint32_t v = 0; v < ict->n_vertices; v++) {
        albedo[v] = vertex_albedo(ict, &skin, middle, v);
    }
    for (uint32_t t = 0; t < ict->n_triangles; t++) {
        const uint32_t *c = ict->triangles[t];
        facet_albedo[t] = (float)((albedo[c[0]] + albedo[c[1]] + albedo[c[2]]) / 3.0);
    }
    free(albedo);
    return 0;
}
