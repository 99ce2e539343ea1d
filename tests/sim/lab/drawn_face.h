/* Faces with known shape, and the descriptions and distances that methods compute from them. A
 * failure fails the running test. */
#ifndef TESTS_SIM_LAB_DRAWN_FACE_H
#define TESTS_SIM_LAB_DRAWN_FACE_H

#include "sim/base/random.h"
#include "sim/lab/methods/method.h"

enum { DRAWN_SIDE = 61 }; /* 3 mm apart: 90 mm on each side of the centre */

#define DRAWN_SPACING_MM 3.0

/* Returns the height of a surface at a place. */
typedef double drawn_height(const void *context, double x, double y);

/* Returns the surface within 86 mm of the centre. Free it with sim_scan_free. */
struct sim_scan *drawn_surface(drawn_height *z, const void *context);

/* A head-like dome with the nose and the hills of one person. */
struct drawn_person {
    uint64_t key;
    double noise_mm, yaw_rad;
    struct sim_random *random; /* source of the noise */
};

drawn_height drawn_relief; /* its context is a struct drawn_person */

/* Gives the scan a skin with spots that are particular to this person, `tone` times as bright. */
void drawn_skin(struct sim_scan *scan, uint64_t key, double tone);

/* Draws the person of a key, with skin and the twelve landmarks. The landmarks differ between
 * people by up to a few millimetres, and have an error of `noise_mm` that differs between takes. */
struct sim_scan *drawn_face(uint64_t key, double noise_mm, uint64_t take);

/* Returns the method's description of a face. Free it with method->discard(). */
void *described(const struct sim_method *method, const void *knowledge,
                const struct sim_scan *scan);

/* Returns the distance between two descriptions. It asserts that the distance is not negative. */
double method_distance(const struct sim_method *method, const void *knowledge, const void *probe,
                       const void *gallery);

#endif
