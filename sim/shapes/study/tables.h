/* isotherm-sim shapes tables: the tables of chapters 4 and 5 of the dissertation (Abdelrahman 2013,
 * 4.1-4.13, 5.1, 5.2) for corpora of ours, with the dissertation's own figures beside them.
 *
 * The corpora differ, so that figures can be compared within a column only. Queries never find
 * themselves nor their undistorted originals, which is stricter than what tables 4.8 and 4.11-4.13
 * of the dissertation did. Further rows that the dissertation does not have are marked. */
#ifndef SIM_SHAPES_STUDY_TABLES_H
#define SIM_SHAPES_STUDY_TABLES_H

#include <stddef.h>
#include <stdio.h>

#include "core/base/fault.h"

struct sim_tables_options {
    const char *corpus;   /* for the nonrigid world data set */
    const char *large;    /* for SHREC'11; NULL: `corpus` again */
    const char *textured; /* for SHREC'13; NULL: tables 5.1 and 5.2 are left out */
    const char *out;      /* directory: tables.csv goes there; made if it is missing */
    size_t queries;       /* how many shapes of `large` are distorted, classes in turn; 0: all */
    size_t seed;
    int smooth; /* see sim_smooth: of all shapes, distorted or not */
    int threads;
};

/* Prints the tables. -EINVAL for a corpus of no two classes; errors of reading, describing and
 * writing; each with a fault. */
int sim_shapes_tables(const struct sim_tables_options *options, FILE *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
