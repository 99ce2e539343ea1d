#include "tests/core/match/formula_face.h"

#include <math.h>
#include <string.h>

/* The surface is a curved forehead with a nose. A brow on one side makes it asymmetric. A wave that
 * depends on `who` makes each person different. */
double formula_face_height_mm(int who, double x, double y)
{
    const double nose = 18.0 * exp(-(x * x + (y + 4.0) * (y + 4.0) / 3.0) / 250.0);
    const double brow = 5.0 *
                        exp(-((x - 25.0) * (x - 25.0) / 3.0 + (y - 35.0) * (y - 35.0)) / 90.0);
    return -0.006 * x * x - 0.003 * (y - 30.0) * (y - 30.0) + nose + brow +
           2.0 * sin(0.06 * (who + 1) * x) * cos(0.05 * who * y + 0.3);
}

static bool inside(double x, double y)
{
    return x * x / (64.0 * 64.0) + (y - 30.0) * (y - 30.0) / (54.0 * 54.0) < 1.0;
}

/* An iteration finds the height above each node. */
struct iso_upper_face formula_face_moved(int who, const struct iso_rigid *motion)
{
    const struct iso_rigid back = iso_rigid_inverse(motion);
    struct iso_upper_face face;
    memset(&face, 0, sizeof face);
    for (int v = 0; v < ISO_UPPER_ROWS; v++) {
        for (int u = 0; u < ISO_UPPER_COLUMNS; u++) {
            struct iso_vec3 at = {0.0, 0.0, 0.0};
            double z = 0.0;
            for (int i = 0; i < 40; i++) {
                at = iso_rigid_apply(&back, iso_vec3(iso_upper_x_mm(u), iso_upper_y_mm(v), z));
                z = iso_rigid_apply(motion,
                                    iso_vec3(at.x, at.y, formula_face_height_mm(who, at.x, at.y)))
                        .z;
            }
            if (inside(at.x, at.y)) {
                face.z_mm[v][u] = (float)z;
                face.kind[v][u] = ISO_UPPER_MEASURED;
            }
        }
    }
    return face;
}

struct iso_upper_face formula_face(int who)
{
    const struct iso_rigid still = iso_rigid_identity();
    return formula_face_moved(who, &still);
}

struct iso_rigid formula_face_motion(double rx, double ry, double rz, double x, double y, double z)
{
    return (struct iso_rigid){iso_mat3_rotation(iso_vec3(rx, ry, rz)), {x, y, z}};
}
