/* Anthroface 3D (Gupta, Markey and Bovik 2010): Euclidean and geodesic distances between
 * anthropometric points of the face, compared after discriminant analysis.
 *
 * It works with the 10 points that can be found automatically (nasion, nose tip, alae, eye and
 * mouth corners; here those of the fitted head), or with 25 points marked by a person. Marks
 * come from landmarks.csv: hand marks of real faces, ground truth of rendered ones. Ground truth
 * knows more than any observer (it leaks identity), so that results with it are an upper bound.
 * The original's stepwise choice of features is missing; the analysis is regularised instead. */
#ifndef SIM_LAB_METHODS_ANTHROFACE_H
#define SIM_LAB_METHODS_ANTHROFACE_H

#include "sim/lab/methods/scan.h"

struct sim_mark {
    const char *name; /* in landmarks.csv; the appliance's landmarks have their own names */
    int ibug;         /* index among the 68 points of iBUG 300-W */
};

/* The 25 points. */
extern const struct sim_mark sim_marks[SIM_MARKS];

/* The index of a mark by its name, or -1. */
int sim_mark_find(const char *name);

#endif
