/* isotherm-sim shapes eval: compares a corpus with itself, or its distorted shapes with it, by
 * methods and classifiers, and writes result files. */
#ifndef SIM_SHAPES_STUDY_STUDY_H
#define SIM_SHAPES_STUDY_STUDY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "core/base/fault.h"
#include "isotherm/shape_method.h"
#include "sim/base/options.h"
#include "sim/shapes/make/distort.h"

struct sim_shapes_study_options {
    const char *corpus, *out;
    struct sim_option_texts methods;     /* names, or "all" (choice.h) */
    struct sim_option_texts classifiers; /* the same; none: each method's own */
    struct sim_distortion distortion;    /* level 0: none */
    size_t queries;                      /* the first shapes of every class in turn; 0: all */
    size_t seed;
    int smooth;   /* see sim_smooth */
    int vertices; /* meshes with more vertices are thinned; 0: no thinning */
    int pictures; /* matches of a query in a picture; 0: no pictures */
    int pairs;    /* eigenpairs; 0: ISO_SHAPE_PAIRS */
    int words;    /* words of vocabularies, or principal components; 0: each method's own */
    struct iso_describe_times times; /* of heat; 0: each method's own */
    int neighbours;                  /* of each point of a cloud; 0: ISO_CLOUD_NEIGHBOURS */
    bool mend;                       /* describe meshes that lose over 1 % of their area */
    bool strict;                     /* fail at the first mesh that cannot be used */
    const char *cache;               /* directory of descriptions; NULL: `out`/cache; "": none */
    int threads;
};

/* Looks at every mesh before the work begins; those that cannot be used are named and left out.
 * If the queries are distorted or not all shapes, classifiers that tell classes learn from all
 * shapes but the query's own, otherwise in ten folds. For the ranking a collaborative classifier
 * chooses its compression and penalty by the classes of all shapes. Prints a line for each method
 * and classifier, and writes below `out`:
 *
 *   measures.csv                       all measures, and times
 *   parameters.json                    options on which figures depend, times and words
 *   meshes.csv                         what was found in each mesh (describe/corpus.h)
 *   cache/                             descriptions for the next run (describe/cache.h)
 *   precision-recall.png               of methods and classifiers that rank; more than twelve are
 *                                      continued in precision-recall-2.png and so on
 *   shapes.png                         some shapes of each class; only with `pictures`
 *   METHOD-CLASSIFIER/distances.csv    a line for each query: its file, then the distance to every
 *                                      item; a query's own item is at 0 and never counts; only if
 *                                      the classifier ranks
 *   METHOD-CLASSIFIER/confusion.csv    how often each class was taken for each class
 *   METHOD-CLASSIFIER/matches.png      first matches of a query of each class; only with `pictures`
 *                                      and if the classifier ranks
 *
 * -EINVAL for an unknown name, and for times that a method cannot have; -ENODATA for a corpus of
 * one shape or one class; -ENOTSUP if the build lacks a method's own classifier; errors of the
 * banks and of writing; each with a fault. */
int sim_shapes_study(const struct sim_shapes_study_options *options, FILE *out,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
