/* Methods of face recognition that can be compared in one run: the appliance's own, the methods
 * that Abdelrahman (2013, figure 6.9) compared it with, and others.
 *
 * A method is a table of functions. All except the appliance's own are pairwise: a face becomes a
 * description, two descriptions have a distance, and the score of a comparison is the negative
 * distance. The appliance's own methods are `hfpc`, which is always the appliance's present method,
 * and `hfpc-metric` and `hfpc-upper`, which are parts of it; sim/lab/match/match.h makes their
 * comparisons.
 *
 * Descriptions and knowledge are opaque. They are on the heap and the method frees them. */
#ifndef SIM_LAB_METHODS_METHOD_H
#define SIM_LAB_METHODS_METHOD_H

#include <stddef.h>

#include "core/base/fault.h"
#include "sim/lab/methods/scan.h"

/* Faces to learn from. Their people are in none of the compared corpora. */
struct sim_training {
    size_t n;
    const struct sim_scan *const *faces; /* [n] */
    const uint32_t *person;              /* [n], below n_people */
    uint32_t n_people;
    const bool *marks; /* [SIM_MARKS]: the points that are known on every face to compare */
};

struct sim_method {
    const char *name;   /* as on the command line */
    const char *source; /* author, year, and differences of this implementation */
    bool marked;        /* works on marked points (sim_scan.mark_mm) */
    bool infrared;      /* needs faces whose frames had an infrared image (sim_scan.reflectance) */

    /* OPTIONAL, with forget. Learns. -EINVAL with a fault if the faces are not sufficient (too
     * few people, no marks), -ENOMEM. forget frees the knowledge; NULL is accepted. */
    int (*train)(const struct sim_training *training, void **knowledge, struct iso_fault *fault);
    void (*forget)(void *knowledge);

    /* REQUIRED, with discard and distance, except for the appliance's own methods, which have none
     * of the three. Several threads may call it at the same time. The description may refer to the
     * face, which outlives it. -ENODATA for a face that cannot be described, -ENOMEM. discard frees
     * the description; NULL is accepted. */
    int (*describe)(const void *knowledge, const struct sim_scan *face, void **description);
    void (*discard)(void *description);
    /* The distance is at least 0 and grows with the difference of the faces. Several threads may
     * call it at the same time. -ENODATA if the two faces have too little in common, -ENOMEM. */
    int (*distance)(const void *knowledge, const void *probe, const void *gallery,
                    double *distance);
};

extern const struct sim_method sim_method_hfpc;
extern const struct sim_method sim_method_hfpc_metric;
extern const struct sim_method sim_method_hfpc_upper;
extern const struct sim_method sim_method_hfpc_literal;
extern const struct sim_method sim_method_hfpc_weighted;
extern const struct sim_method sim_method_hfpc_weighted_1;
extern const struct sim_method sim_method_cp_hk;
extern const struct sim_method sim_method_icp;
extern const struct sim_method sim_method_icp_upper;
extern const struct sim_method sim_method_eigensurfaces;
extern const struct sim_method sim_method_fishersurfaces;
extern const struct sim_method sim_method_anthroface_10;
extern const struct sim_method sim_method_anthroface_25;

enum { SIM_METHODS = 13 };

/* All methods, the appliance's own first; NULL ends the list. */
extern const struct sim_method *const sim_methods[SIM_METHODS + 1];

/* The method with this name, or NULL. */
const struct sim_method *sim_method_find(const char *name);

/* Whether the method is pairwise (all except the appliance's own). */
static inline bool sim_method_pairwise(const struct sim_method *method)
{
    return method->describe != NULL;
}

#endif
