#include "sim/train/head/quadric.h"

void sim_quadric_add_plane(struct sim_quadric *q, struct iso_vec3 n, struct iso_vec3 point,
                           double weight)
{
    const double d = -iso_dot(n, point);
    q->axx += weight * n.x * n.x;
    q->axy += weight * n.x * n.y;
    q->axz += weight * n.x * n.z;
    q->ayy += weight * n.y * n.y;
    q->ayz += weight * n.y * n.z;
    q->azz += weight * n.z * n.z;
    q->bx += weight * d * n.x;
    q->by += weight * d * n.y;
    q->bz += weight * d * n.z;
    q->c += weight * d * d;
}

void sim_quadric_add(struct sim_quadric *q, const struct sim_quadric *r)
{
    q->axx += r->axx;
    q->axy += r->axy;
    q->axz += r->axz;
    q->ayy += r->ayy;
    q->ayz += r->ayz;
    q->azz += r->azz;
    q->bx += r->bx;
    q->by += r->by;
    q->bz += r->bz;
    q->c += r->c;
    q->area_mm2 += r->area_mm2;
}

double sim_quadric_at(const struct sim_quadric *q, struct iso_vec3 p)
{
    return p.x * (q->axx * p.x + 2.0 * (q->axy * p.y + q->axz * p.z + q->bx)) +
           p.y * (q->ayy * p.y + 2.0 * (q->ayz * p.z + q->by)) +
           p.z * (q->azz * p.z + 2.0 * q->bz) + q->c;
}
