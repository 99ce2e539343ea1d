/* Methods of face recognition that can be compared in one run: the appliance's own and those that
 * Abdelrahman (2013, figure 6.9) measured it against.
 *
 * A method is a table of functions. All but the appliance's own are pairwise: a face becomes a
 * description, two descriptions have a distance, and the score of a comparison is the negative
 * distance. The appliance's own methods are `hfpc`, which is always what the appliance does at
 * present, and `hfpc-metric` and `hfpc-upper`, which are parts of it; their comparisons are those
 * of sim/lab/match/match.h.
 *
 * Descriptions and knowledge are opaque, made on the heap and freed by the method. */
#ifndef SIM_LAB_METHODS_METHOD_H
#define SIM_LAB_METHODS_METHOD_H

#include <stddef.h>

#include "core/base/fault.h"
#include "sim/lab/methods/scan.h"

/* Faces to learn from: of people who are in no corpus that is compared. */
struct sim_training {
    size_t n;
    const struct sim_scan *const *faces; /* [n] */
    const uint32_t *person;              /* [n], below n_people */
    uint32_t n_people;
    const bool
        *marks; /* [SIM_MARKS]: the points that are known on every face that will be compared */
};

struct sim_method {
    const char *name;   /* as on the command line */
    const char *source; /* author, year, and what is different here */
    bool marked;        /* works on points that somebody marked (sim_scan.mark_mm) */
    bool infrared;      /* needs faces whose frames had an infrared image (sim_scan.reflectance) */

    /* OPTIONAL, with forget. Learns. -EINVAL with a fault if the faces cannot teach it (too few
     * people, no marks), -ENOMEM. */
    int (*train)(const struct sim_training *training, void **knowledge, struct iso_fault *fault);
    void (*forget)(void *knowledge);

    /* REQUIRED but for the appliance's own methods, which have neither. May be called by several
     * threads at once. The description may refer to the face, which outlives it. -ENODATA for a
     * face that cannot be described, -ENOMEM. */
    int (*describe)(const void *knowledge, const struct sim_scan *face, void **description);
    void (*discard)(void *description);
    /* Not negative; it grows as the faces differ. May be called by several threads at once.
     * -ENODATA if the two have too little in common. */
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

/* All of them, the appliance's own first, with a NULL at the end. */
extern const struct sim_method *const sim_methods[SIM_METHODS + 1];

/* NULL if there is none of that name. */
const struct sim_method *sim_method_find(const char *name);

/* Whether the method compares descriptions of its own (all but the appliance's own). */
static inline bool sim_method_pairwise(const struct sim_method *method)
{
    return method->describe != NULL;
}

#endif
