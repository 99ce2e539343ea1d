/* Faces whose shape is known, and what methods make of them. Failures fail the running test. */
#ifndef TESTS_SIM_LAB_DRAWN_FACE_H
#define TESTS_SIM_LAB_DRAWN_FACE_H

#include "sim/base/random.h"
#include "sim/lab/methods/method.h"

enum { DRAWN_SIDE = 61 }; /* 3 mm apart: 90 mm about the middle */

#define DRAWN_SPACING_MM 3.0

/* The height of a surface at a place. */
typedef double drawn_height(const void *context, double x, double y);

/* The surface within 86 mm of the middle; free with sim_scan_free. */
struct sim_scan *drawn_surface(drawn_height *z, const void *context);

/* A head-like dome with a nose and hills of a person. */
struct drawn_person {
    uint64_t key;
    double noise_mm, yaw_rad;
    struct sim_random *random; /* of the noise */
};

drawn_height drawn_relief; /* of a struct drawn_person */

/* Gives the scan skin with spots of a person's own, `tone` times as bright. */
void drawn_skin(struct sim_scan *scan, uint64_t key, double tone);

/* Such a person with skin and the twelve landmarks, which are where this person has them, up to a
 * few millimetres away, and as wrong as `noise_mm` makes them in this take. */
struct sim_scan *drawn_face(uint64_t key, double noise_mm, uint64_t take);

/* The method's description of a face. */
void *described(const struct sim_method *method, const void *knowledge,
                const struct sim_scan *scan);

/* The distance between two descriptions, which is not below zero. */
double method_distance(const struct sim_method *method, const void *knowledge, const void *probe,
                       const void *gallery);

#endif
