/* isotherm-sim shapes tables: the tables of chapters 4 and 5 of the dissertation (Abdelrahman 2013,
 * 4.1-4.13, 5.1, 5.2) for this project's corpora, next to the dissertation's own figures.
 *
 * The corpora differ, so compare figures within a column only. Queries never find themselves or
 * their undistorted originals, which is stricter than tables 4.8 and 4.11-4.13 of the
 * dissertation. Rows that the dissertation does not have show "-" in place of its figures. */
#ifndef SIM_SHAPES_STUDY_TABLES_H
#define SIM_SHAPES_STUDY_TABLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "core/base/fault.h"

struct sim_tables_options {
    const char *corpus;   /* stands for the nonrigid world data set */
    const char *large;    /* stands for SHREC'11; NULL: the same as `corpus` */
    const char *textured; /* stands for SHREC'13; NULL: tables 5.1 and 5.2 are left out */
    const char *out;      /* directory for tables.csv, created if it is missing */
    size_t queries; /* number of shapes of a corpus to distort, from its classes in turn; 0: all */
    size_t seed;
    int smooth;        /* see sim_smooth; applied to all shapes, distorted or not */
    bool strict;       /* fail at the first mesh that cannot be used */
    const char *cache; /* directory of descriptions; NULL: `out`/cache; "": none */
    int threads;
};

/* Meshes that cannot be used are named on standard error and left out. Descriptions are taken from
 * the cache and put into it (describe/cache.h). Prints the tables and writes tables.csv. -EINVAL
 * for a corpus with fewer than two classes; errors of reading, describing and writing; each with a
 * fault. */
int sim_shapes_tables(const struct sim_tables_options *options, FILE *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
