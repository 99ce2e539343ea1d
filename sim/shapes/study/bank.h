/* The descriptions of all shapes of a corpus by all methods: the part of a study that takes time.
 */
#ifndef SIM_SHAPES_STUDY_BANK_H
#define SIM_SHAPES_STUDY_BANK_H

#include "isotherm/shape_method.h"
#include "sim/shapes/make/distort.h"
#include "sim/shapes/make/manifest.h"

struct sim_bank_options {
    const char *corpus; /* directory of the manifest's files */
    const struct sim_shape_manifest *manifest;
    const struct iso_shape_method *const *methods; /* [n_methods] */
    int n_methods;
    const int32_t *rows; /* [n_rows] of the manifest to describe; NULL: all of them */
    int32_t n_rows;
    const struct sim_distortion *distortion; /* NULL: as they are */
    uint64_t seed;                           /* of the distortion */
    int smooth;       /* double steps of the smoothing filter before anything else */
    int32_t vertices; /* meshes of more are thinned to so many; 0: none are */
    int threads;
};

struct sim_bank {
    int n_methods;
    int32_t n;
    int32_t *row;                               /* [n] of the manifest */
    struct iso_shape_description **description; /* [n_methods][n] */
    double *seconds;                            /* [n_methods] thread time in all */
    double shape_seconds;                       /* the same, of reading and of eigenpairs */
    double elapsed_seconds;
    double mean_vertices;
    long peak_kib; /* of the process's memory so far */
};

/* Reads, distorts, smooths and describes the shapes, each by all methods in one thread. A shape
 * that cannot be read or described fails it all: -EBADMSG, -ENODATA, -ENOENT, ..., with a fault
 * that names its file; -ENOMEM. */
int sim_bank_new(const struct sim_bank_options *options, struct sim_bank **out,
                 struct iso_fault *fault) __attribute__((warn_unused_result));
void sim_bank_free(struct sim_bank *bank);

/* The descriptions by one method: [n]. */
const struct iso_shape_description *const *sim_bank_of(const struct sim_bank *bank, int method);

/* Reads a shape as a bank does it: mended, thinned, distorted, smoothed. `row` seeds the
 * distortion.
 */
int sim_bank_read(const struct sim_bank_options *options, int32_t row,
                  struct iso_coloured_mesh *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
