/* Corpora of generated shapes: mesh files and manifest.csv (manifest.h).
 *
 * `plain` is like the nonrigid world data set of chapter 4: bodies of several kinds, each in
 * several poses, as OFF. The first SIM_SPECIES classes are the species themselves; further classes
 * have the limbs of a species in other proportions.
 *
 * `textured` is like SHREC'13 of section 5.4, with colours, as PLY. Each class has two bodies
 * with three coats each. Each of these null shapes has four transformations (another pose;
 * stretched; bulging; noisy), and only these are written: 24 shapes. The class in the manifest is
 * SHAPE/COAT. */
#ifndef SIM_SHAPES_MAKE_GENERATE_H
#define SIM_SHAPES_MAKE_GENERATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

struct sim_shapes_options {
    const char *preset; /* "plain" or "textured" */
    const char *out;    /* directory, created if it is missing */
    const char *format; /* "off", "ply" or "vert"; NULL: the preset's own */
    size_t seed;
    size_t classes;  /* 0: 12 plain, 10 textured */
    size_t shapes;   /* plain: total number, distributed to the classes in turn; 0: 148 */
    size_t vertices; /* of each shape; 0: 3000 */
    bool rest;       /* also write rest/NAME.npy: where each vertex is on the body at rest */
    int threads;     /* 1..64 */
};

enum { SIM_SHAPES_CLASSES_MAX = 60 };

/* The same options give the same bytes, whatever the number of threads. *n_written is the number
 * of shapes. -EINVAL for options out of range; -ENOMEM; errors of writing; each with a fault. */
int sim_shapes_generate(const struct sim_shapes_options *options, int32_t *n_written,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
