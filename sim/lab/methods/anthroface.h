/* Anthroface 3D (Gupta, Markey and Bovik 2010): Euclidean and geodesic distances between
 * anthropometric points of the face, compared after discriminant analysis.
 *
 * With the 10 points that can be found automatically (nasion, nose tip, alae, eye and mouth
 * corners; here those of the fitted head), and with 25 that somebody has marked. Marks come from
 * landmarks.csv: hand marks of real faces, ground truth of rendered ones. Ground truth knows more
 * than anybody who looks (it leaks identity), so what is reported with it is an upper bound.
 * Not here: the original's stepwise choice of features; instead the analysis is regularised. */
#ifndef SIM_LAB_METHODS_ANTHROFACE_H
#define SIM_LAB_METHODS_ANTHROFACE_H

#include "sim/lab/methods/scan.h"

struct sim_mark {
    const char *name; /* in landmarks.csv; the appliance's landmarks have their own names */
    int ibug;         /* index among the 68 points of iBUG 300-W */
};

/* The 25 points, by Farkas's names where Gupta has them. */
extern const struct sim_mark sim_marks[SIM_MARKS];

/* -1 if no mark has the name. */
int sim_mark_find(const char *name);

#endif
