/** @file
 * 3-vectors, 3x3 matrices and rigid transforms in double precision, inline and by value.
 *
 * A transform is named for its frames, destination first: `camera_from_face` takes a point of the
 * face frame to the camera frame. Lengths are millimetres unless a name says otherwise. */
#ifndef ISOTHERM_VEC_H
#define ISOTHERM_VEC_H

#include <math.h>

/** A point or a vector of space; millimetres unless a name says otherwise. */
struct iso_vec3 {
    double x; /**< First coordinate. */
    double y; /**< Second coordinate. */
    double z; /**< Third coordinate. */
};

/** A 3x3 matrix. */
struct iso_mat3 {
    double m[3][3]; /**< [row][column]. */
};

/** A rigid motion: x -> rotation * x + translation. */
struct iso_rigid {
    struct iso_mat3 rotation;       /**< A proper orthogonal matrix. */
    struct iso_vec3 translation_mm; /**< Applied after the rotation, millimetres. */
};

/** A vector from its coordinates.
 *
 * @param x  First coordinate.
 * @param y  Second coordinate.
 * @param z  Third coordinate.
 * @return (x, y, z). */
static inline struct iso_vec3 iso_vec3(double x, double y, double z)
{
    return (struct iso_vec3){x, y, z};
}

/** Sum of two vectors.
 *
 * @param a  A vector.
 * @param b  Another one.
 * @return a + b. */
static inline struct iso_vec3 iso_add(struct iso_vec3 a, struct iso_vec3 b)
{
    return iso_vec3(a.x + b.x, a.y + b.y, a.z + b.z);
}

/** Difference of two vectors.
 *
 * @param a  A vector.
 * @param b  Another one.
 * @return a - b. */
static inline struct iso_vec3 iso_sub(struct iso_vec3 a, struct iso_vec3 b)
{
    return iso_vec3(a.x - b.x, a.y - b.y, a.z - b.z);
}

/** A vector times a number.
 *
 * @param s  The number.
 * @param a  The vector.
 * @return s a. */
static inline struct iso_vec3 iso_scale(double s, struct iso_vec3 a)
{
    return iso_vec3(s * a.x, s * a.y, s * a.z);
}

/** A vector and a multiple of another one.
 *
 * @param a  The vector.
 * @param s  The factor.
 * @param b  The other vector.
 * @return a + s b. */
static inline struct iso_vec3 iso_madd(struct iso_vec3 a, double s, struct iso_vec3 b)
{
    return iso_vec3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}

/** Scalar product.
 *
 * @param a  A vector.
 * @param b  Another one.
 * @return The scalar product. */
static inline double iso_dot(struct iso_vec3 a, struct iso_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/** Vector product.
 *
 * @param a  A vector.
 * @param b  Another one.
 * @return a x b. */
static inline struct iso_vec3 iso_cross(struct iso_vec3 a, struct iso_vec3 b)
{
    return iso_vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

/** Length of a vector.
 *
 * @param a  The vector.
 * @return Its Euclidean length, in the unit of the vector. */
static inline double iso_norm(struct iso_vec3 a)
{
    return sqrt(iso_dot(a, a));
}

/** A vector of length 1 in the direction of another one.
 *
 * @param a  The vector.
 * @return The unit vector; the zero vector stays zero. */
static inline struct iso_vec3 iso_unit(struct iso_vec3 a)
{
    double n = iso_norm(a);
    return n > 0.0 ? iso_scale(1.0 / n, a) : a;
}

/** The identity matrix.
 *
 * @return The matrix that leaves every vector as it is. */
static inline struct iso_mat3 iso_mat3_identity(void)
{
    return (struct iso_mat3){{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

/** A matrix times a vector.
 *
 * @param a  The matrix.
 * @param v  The vector.
 * @return a v. */
static inline struct iso_vec3 iso_mat3_apply(const struct iso_mat3 *a, struct iso_vec3 v)
{
    return iso_vec3(a->m[0][0] * v.x + a->m[0][1] * v.y + a->m[0][2] * v.z,
                    a->m[1][0] * v.x + a->m[1][1] * v.y + a->m[1][2] * v.z,
                    a->m[2][0] * v.x + a->m[2][1] * v.y + a->m[2][2] * v.z);
}

/** Product of two matrices.
 *
 * @param a  The left factor.
 * @param b  The right factor.
 * @return a b. */
static inline struct iso_mat3 iso_mat3_mul(const struct iso_mat3 *a, const struct iso_mat3 *b)
{
    struct iso_mat3 c;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            c.m[i][j] = a->m[i][0] * b->m[0][j] + a->m[i][1] * b->m[1][j] + a->m[i][2] * b->m[2][j];
        }
    }
    return c;
}

/** A matrix with rows and columns exchanged.
 *
 * @param a  The matrix.
 * @return Its transpose, which is the inverse of a rotation. */
static inline struct iso_mat3 iso_mat3_transpose(const struct iso_mat3 *a)
{
    struct iso_mat3 c;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            c.m[i][j] = a->m[j][i];
        }
    }
    return c;
}

/** A rotation about an axis through the origin (Rodrigues 1840).
 *
 * @param w_rad  The axis; its length is the angle in radians.
 * @return The rotation matrix. */
struct iso_mat3 iso_mat3_rotation(struct iso_vec3 w_rad);

/** The rigid motion that moves nothing.
 *
 * @return The identity. */
static inline struct iso_rigid iso_rigid_identity(void)
{
    return (struct iso_rigid){iso_mat3_identity(), {0, 0, 0}};
}

/** A rigid motion of a point.
 *
 * @param a  The motion.
 * @param v  The point, millimetres.
 * @return The moved point, millimetres. */
static inline struct iso_vec3 iso_rigid_apply(const struct iso_rigid *a, struct iso_vec3 v)
{
    return iso_add(iso_mat3_apply(&a->rotation, v), a->translation_mm);
}

/** Two rigid motions, one after the other.
 *
 * @param a  The motion that is applied last.
 * @param b  The motion that is applied first.
 * @return x -> a(b(x)). */
static inline struct iso_rigid iso_rigid_mul(const struct iso_rigid *a, const struct iso_rigid *b)
{
    return (struct iso_rigid){iso_mat3_mul(&a->rotation, &b->rotation),
                              iso_rigid_apply(a, b->translation_mm)};
}

/** The inverse of a rigid motion.
 *
 * @param a  The motion.
 * @return The motion that undoes it. */
static inline struct iso_rigid iso_rigid_inverse(const struct iso_rigid *a)
{
    struct iso_mat3 rt = iso_mat3_transpose(&a->rotation);
    return (struct iso_rigid){rt, iso_scale(-1.0, iso_mat3_apply(&rt, a->translation_mm))};
}

#endif
