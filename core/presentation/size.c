#include "core/presentation/size.h"

#include <errno.h>
#include <string.h>

#include "core/landmark/pose_tally.h"
#include "core/math/solve.h"

enum { UNKNOWNS = 7, ITERATIONS = 7, MEASURED_MIN = 30 };

static const double cutoff_first_mm = 14.0, cutoff_last_mm = 7.0;
/* Far off, the surface of another size is not followed from the size of people. */
static const double starts[] = {1.0, 0.72, 1.35};
static const double scale_min = 0.3, scale_max = 2.2;
/* Keeps the scale where a flat patch does not say it: half a vertex's weight at an arm of 60 mm. */
static const double scale_stiffness = 0.5 * 60.0 * 60.0 * 1e-3;

struct similarity {
    struct iso_rigid pose;
    double scale;
};

static int step(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                double cutoff_mm, struct similarity *s)
{
    double h[UNKNOWNS * UNKNOWNS] = {0}, g[UNKNOWNS] = {0};
    int measured = 0;
    for (int i = 0; i < vertices->n; i++) {
        struct iso_vec3 normal = iso_mat3_apply(&s->pose.rotation, vertices->normal[i]);
        struct iso_vec3 arm = iso_mat3_apply(&s->pose.rotation,
                                             iso_scale(s->scale, vertices->point_mm[i]));
        double r;
        if (iso_meet(frame, iso_add(arm, s->pose.translation_mm), normal, &r) !=
            ISO_MEETING_MEASURED) {
            continue;
        }
        measured++;
        double w = iso_tukey(r, cutoff_mm) * vertices->weight[i];
        struct iso_vec3 turn = iso_cross(arm, normal);
        /* The scale as a logarithm: d(s p)/d(ln s) = s p. */
        const double j[UNKNOWNS] = {turn.x,   turn.y,   turn.z,  normal.x,
                                    normal.y, normal.z, iso_dot(arm, normal)};
        for (int a = 0; a < UNKNOWNS; a++) {
            for (int b = 0; b <= a; b++) {
                h[a * UNKNOWNS + b] += w * j[a] * j[b];
            }
            g[a] -= w * r * j[a];
        }
    }
    h[UNKNOWNS * UNKNOWNS - 1] += scale_stiffness;
    if (measured < MEASURED_MIN || iso_cholesky_factorise(h, UNKNOWNS)) {
        return -ENODATA;
    }
    iso_cholesky_solve(h, UNKNOWNS, g);
    struct iso_mat3 turn = iso_mat3_rotation(iso_vec3(g[0], g[1], g[2]));
    s->pose.rotation = iso_mat3_mul(&turn, &s->pose.rotation);
    s->pose.translation_mm = iso_add(s->pose.translation_mm, iso_vec3(g[3], g[4], g[5]));
    s->scale *= exp(fmin(fmax(g[6], -0.2), 0.2));
    return s->scale > scale_min && s->scale < scale_max ? 0 : -ENODATA;
}

static struct iso_size judge(const struct iso_pose_vertices *vertices,
                             const struct iso_frame *frame, const struct similarity *s)
{
    struct iso_pose_tally tally = {0};
    struct iso_pose_fit fit;
    for (int i = 0; i < vertices->n; i++) {
        struct iso_vec3 place = iso_rigid_apply(&s->pose,
                                                iso_scale(s->scale, vertices->point_mm[i]));
        double r = 0.0;
        enum iso_meeting meeting =
            iso_meet(frame, place, iso_mat3_apply(&s->pose.rotation, vertices->normal[i]), &r);
        iso_pose_tally_add(&tally, meeting, r);
    }
    iso_pose_tally_finish(&tally, &fit);
    return (struct iso_size){s->scale, fit.cost_mm2, fit.coverage};
}

int iso_size_measure(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                     const struct iso_rigid *camera_from_face, struct iso_size *out)
{
    struct iso_size best = {.cost_mm2 = INFINITY};
    double fall = pow(cutoff_last_mm / cutoff_first_mm, 1.0 / (ITERATIONS - 1));
    for (size_t k = 0; k < sizeof starts / sizeof starts[0]; k++) {
        struct similarity s = {*camera_from_face, starts[k]};
        double cutoff = cutoff_first_mm;
        int error = 0;
        for (int i = 0; i < ITERATIONS && !error; i++, cutoff *= fall) {
            error = step(vertices, frame, cutoff, &s);
        }
        if (!error) {
            struct iso_size size = judge(vertices, frame, &s);
            best = size.cost_mm2 < best.cost_mm2 ? size : best;
        }
    }
    if (!isfinite(best.cost_mm2)) {
        return -ENODATA;
    }
    *out = best;
    return 0;
}
