#include "isotherm/vec.h"

struct iso_mat3 iso_mat3_rotation(struct iso_vec3 w)
{
    const double angle = iso_norm(w);
    struct iso_mat3 r = iso_mat3_identity();
    if (angle <= 0.0) {
        return r;
    }
    const struct iso_vec3 u = iso_scale(1.0 / angle, w);
    double s = sin(angle), c = 1.0 - cos(angle);
    /* R = I + sin(a) [u]x + (1 - cos(a)) [u]x^2 */
    r.m[0][0] -= c * (u.y * u.y + u.z * u.z);
    r.m[1][1] -= c * (u.x * u.x + u.z * u.z);
    r.m[2][2] -= c * (u.x * u.x + u.y * u.y);
    r.m[0][1] = c * u.x * u.y - s * u.z;
    r.m[1][0] = c * u.x * u.y + s * u.z;
    r.m[0][2] = c * u.x * u.z + s * u.y;
    r.m[2][0] = c * u.x * u.z - s * u.y;
    r.m[1][2] = c * u.y * u.z - s * u.x;
    r.m[2][1] = c * u.y * u.z + s * u.x;
    return r;
}
