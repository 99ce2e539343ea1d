/* The round solids of sim/world/prop/solid.h: tubes and superellipsoids. */
#include <errno.h>

#include "sim/world/prop/solid.h"

enum {
    TUBE_AROUND = 17,
    CAP_RINGS = 5, /* of half a sphere at either end of a tube */
    ELLIPSOID_ROWS = 49,
    ELLIPSOID_COLUMNS = 97,
    JOINTS_MAX = 16,
};

static const double pi = 3.14159265358979324;

/* One cross-section of a tube. */
struct ring {
    struct iso_vec3 middle, across, along; /* two unit vectors that span it */
    double radius_mm;
};

static void place_ring(const struct ring *ring, struct iso_vec3 *row)
{
    for (int c = 0; c < TUBE_AROUND; c++) {
        const double angle = 2.0 * pi * c / (TUBE_AROUND - 1);
        struct iso_vec3 p = iso_madd(ring->middle, ring->radius_mm * cos(angle), ring->across);
        row[c] = iso_madd(p, ring->radius_mm * sin(angle), ring->along);
    }
}

/* The direction of the polyline at a joint: the mean of the two pieces that meet there. */
static struct iso_vec3 direction_at(const struct sim_joint *joints, size_t n, size_t i)
{
    struct iso_vec3 before = {0, 0, 0}, after = {0, 0, 0};
    if (i > 0) {
        before = iso_unit(iso_sub(joints[i].at_mm, joints[i - 1].at_mm));
    }
    if (i + 1 < n) {
        after = iso_unit(iso_sub(joints[i + 1].at_mm, joints[i].at_mm));
    }
    return iso_unit(iso_add(before, after));
}

/* A unit vector perpendicular to `direction`, close to `hint` if possible. It is carried along
 * the tube, so that the tube does not twist. */
static struct iso_vec3 square_to(struct iso_vec3 direction, struct iso_vec3 hint)
{
    struct iso_vec3 flat = iso_madd(hint, -iso_dot(hint, direction), direction);
    if (iso_norm(flat) < 1e-3) {
        hint = fabs(direction.x) < 0.8 ? iso_vec3(1, 0, 0) : iso_vec3(0, 1, 0);
        flat = iso_madd(hint, -iso_dot(hint, direction), direction);
    }
    return iso_unit(flat);
}

/* Places the rings of half a sphere; `side` is -1 before the first joint, +1 behind the last. Ring
 * 0 is at the pole of the first cap, and next to the rim of the last. */
static void place_cap(struct ring rim, struct iso_vec3 direction, int side, struct iso_vec3 *rows)
{
    for (int k = 0; k < CAP_RINGS; k++) {
        const double angle = 0.5 * pi * (side < 0 ? CAP_RINGS - k : k + 1) / CAP_RINGS;
        struct ring ring = rim;
        ring.middle = iso_madd(rim.middle, side * rim.radius_mm * sin(angle), direction);
        ring.radius_mm = rim.radius_mm * cos(angle);
        place_ring(&ring, rows + (size_t)k * TUBE_AROUND);
    }
}

int sim_solid_tube(const struct sim_joint *joints, size_t n_joints, enum sim_material material,
                   struct sim_solid **out)
{
    if (n_joints < 2 || n_joints > JOINTS_MAX) {
        return -EINVAL;
    }
    for (size_t i = 0; i < n_joints; i++) {
        if (!(joints[i].radius_mm > 0.0)) {
            return -EINVAL;
        }
    }
    struct sim_solid *solid;
    const int error = sim_solid_sheet((uint32_t)n_joints + 2 * CAP_RINGS, TUBE_AROUND, material,
                                      &solid);
    if (error != 0) {
        return error;
    }
    struct iso_vec3 hint = {1, 0, 0}, *row = solid->vertices_mm;
    for (size_t i = 0; i < n_joints; i++) {
        struct iso_vec3 direction = direction_at(joints, n_joints, i);
        hint = square_to(direction, hint);
        struct ring ring = {joints[i].at_mm, hint, iso_cross(direction, hint), joints[i].radius_mm};
        if (i == 0) {
            place_cap(ring, direction, -1, row);
            row += (size_t)CAP_RINGS * TUBE_AROUND;
        }
        place_ring(&ring, row);
        row += TUBE_AROUND;
        if (i + 1 == n_joints) {
            place_cap(ring, direction, 1, row);
        }
    }
    *out = solid;
    return 0;
}

static double signed_power(double x, double exponent)
{
    return copysign(pow(fabs(x), exponent), x);
}

int sim_solid_superellipsoid(struct iso_vec3 half_mm, double roundness, enum sim_material material,
                             struct sim_solid **out)
{
    if (!(half_mm.x > 0.0 && half_mm.y > 0.0 && half_mm.z > 0.0) ||
        !(roundness > 0.0 && roundness <= 1.0)) {
        return -EINVAL;
    }
    struct sim_solid *solid;
    const int error = sim_solid_sheet(ELLIPSOID_ROWS, ELLIPSOID_COLUMNS, material, &solid);
    if (error != 0) {
        return error;
    }
    for (int r = 0; r < ELLIPSOID_ROWS; r++) {
        const double latitude = pi * ((double)r / (ELLIPSOID_ROWS - 1) - 0.5);
        const double ring = signed_power(cos(latitude), roundness);
        for (int c = 0; c < ELLIPSOID_COLUMNS; c++) {
            const double longitude = 2.0 * pi * c / (ELLIPSOID_COLUMNS - 1);
            solid->vertices_mm[r * ELLIPSOID_COLUMNS + c] = iso_vec3(
                half_mm.x * ring * signed_power(cos(longitude), roundness),
                half_mm.y * signed_power(sin(latitude), roundness),
                half_mm.z * ring * signed_power(sin(longitude), roundness));
        }
    }
    *out = solid;
    return 0;
}
