/* Describes all shapes of a corpus by all methods. This is the slow part of a study. */
#ifndef SIM_SHAPES_STUDY_BANK_H
#define SIM_SHAPES_STUDY_BANK_H

#include "isotherm/shape_method.h"
#include "sim/shapes/describe/source.h"
#include "sim/shapes/make/manifest.h"

struct sim_bank_options {
    const char *corpus; /* directory of the manifest's files */
    const struct sim_shape_manifest *manifest;
    const struct iso_shape_method *const *methods; /* [n_methods] */
    int n_methods;
    const int32_t *rows; /* [n_rows] of the manifest to describe; NULL: all of them */
    int32_t n_rows;
    struct sim_source_options source; /* how a file becomes a mesh */
    int32_t n_pairs;                  /* eigenpairs; 0: ISO_SHAPE_PAIRS */
    struct iso_describe_times times;  /* of heat; 0: each method's own */
    const char *cache; /* directory of earlier descriptions (describe/cache.h); NULL: none */
    bool skip;         /* leave out shapes that cannot be described, and name them */
    int threads;
};

struct sim_bank {
    int n_methods;
    int32_t n;
    int32_t *row;                               /* [n] of the manifest */
    struct iso_shape_description **description; /* [n_methods][n] */
    double *seconds;                            /* [n_methods] total thread time */
    double shape_seconds;                       /* the same for reading and for eigenpairs */
    double elapsed_seconds;
    double mean_vertices;
    int32_t n_known; /* descriptions that were in the cache */
    long peak_kib;   /* peak memory of the process so far */
};

/* Reads, thins, distorts, smooths and describes the shapes. One thread describes a shape by all
 * methods; methods that share a description make it once. If one shape cannot be read or described,
 * the whole call fails without `skip`, or if no shape is left: -EBADMSG, -ENODATA, -ENOENT, ...,
 * with a fault that names its file; -ENOMEM. With `skip` such a shape is named on standard error,
 * and the bank has only the others. */
int sim_bank_new(const struct sim_bank_options *options, struct sim_bank **out,
                 struct iso_fault *fault) __attribute__((warn_unused_result));

/* Removes from the manifest the rows that a bank of all its rows has not, because they could not be
 * described. Afterwards the bank's shapes are all rows in their order. -ENOMEM. */
int sim_bank_match(struct sim_bank *bank, struct sim_shape_manifest *manifest)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_bank_free(struct sim_bank *bank);

/* The descriptions of all shapes by one method: [n]. */
const struct iso_shape_description *const *sim_bank_of(const struct sim_bank *bank, int method);

/* Reads the shape of a row of the manifest in the same way as a bank: mended, thinned, distorted,
 * smoothed. Errors of sim_source_read, with a fault. */
int sim_bank_read(const struct sim_bank_options *options, int32_t row,
                  struct iso_coloured_mesh *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
