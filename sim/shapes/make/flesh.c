#include "sim/shapes/make/flesh.h"

#include <stdbool.h>

/* R / r. With a larger value, neighbours merge over a larger distance. */
const double sim_flesh_reach = 1.8;

/* (1 - 1 / reach^2)^3.5: see line_integral. */
const double sim_flesh_level = 0.2748;

/* Integral of (a - u^2)^3 from `from` to `to`, in units of R. */
static double line_integral(double a, double from, double to)
{
    const double f2 = from * from, t2 = to * to;
    const double at_to = to * (a * a * a + t2 * (-a * a + t2 * (0.6 * a - t2 / 7.0)));
    const double at_from = from * (a * a * a + f2 * (-a * a + f2 * (0.6 * a - f2 / 7.0)));
    return at_to - at_from;
}

static double clamped(double x, double low, double high)
{
    if (x < low) {
        return low;
    }
    return x > high ? high : x;
}

/* Whether a coordinate is farther from a bone than its field reaches. */
static bool beyond(double x, double from, double to, double reach)
{
    return x < fmin(from, to) - reach || x > fmax(from, to) + reach;
}

double sim_flesh_bone(const struct sim_bone *bone, struct iso_vec3 p_mm)
{
    const double most = sim_flesh_reach * fmax(bone->radius_from_mm, bone->radius_to_mm);
    if (beyond(p_mm.x, bone->from_mm.x, bone->to_mm.x, most) ||
        beyond(p_mm.y, bone->from_mm.y, bone->to_mm.y, most) ||
        beyond(p_mm.z, bone->from_mm.z, bone->to_mm.z, most)) {
        return 0.0; /* the same result as below, but faster: most points are far from most bones */
    }
    struct iso_vec3 axis = iso_sub(bone->to_mm, bone->from_mm), d = iso_sub(p_mm, bone->from_mm);
    const double length = iso_norm(axis), along = iso_dot(d, axis) / length;
    const double share = clamped(along / length, 0.0, 1.0);
    const double radius = bone->radius_from_mm +
                          share * (bone->radius_to_mm - bone->radius_from_mm);
    const double reach = sim_flesh_reach * radius;
    const double a = 1.0 - (iso_dot(d, d) - along * along) / (reach * reach);
    if (a <= 0.0) {
        return 0.0;
    }
    const double half = sqrt(a); /* reach of the kernel along the axis, in units of R */
    const double from = clamped(-along / reach, -half, half);
    const double to = clamped((length - along) / reach, -half, half);
    return line_integral(a, from, to) *
           (35.0 / 32.0); /* scaled to 1 on the axis of an endless line */
}

double sim_flesh_field(const struct sim_skeleton *skeleton, struct iso_vec3 p_mm)
{
    double sum = 0.0;
    for (int b = 0; b < skeleton->n_bones; b++) {
        sum += sim_flesh_bone(&skeleton->bone[b], p_mm);
    }
    return sum;
}

struct iso_vec3 sim_flesh_gradient(const struct sim_skeleton *skeleton, struct iso_vec3 p)
{
    const double h = 0.02; /* mm */
    struct iso_vec3 forward = iso_vec3(sim_flesh_field(skeleton, iso_vec3(p.x + h, p.y, p.z)),
                                       sim_flesh_field(skeleton, iso_vec3(p.x, p.y + h, p.z)),
                                       sim_flesh_field(skeleton, iso_vec3(p.x, p.y, p.z + h)));
    struct iso_vec3 backward = iso_vec3(sim_flesh_field(skeleton, iso_vec3(p.x - h, p.y, p.z)),
                                        sim_flesh_field(skeleton, iso_vec3(p.x, p.y - h, p.z)),
                                        sim_flesh_field(skeleton, iso_vec3(p.x, p.y, p.z - h)));
    return iso_scale(0.5 / h, iso_sub(forward, backward));
}
