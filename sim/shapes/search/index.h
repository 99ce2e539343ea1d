/* isotherm-sim shapes index: describes a folder of meshes and clouds once, so that others can be
 * looked for in it later. An index is a directory:
 *
 *   index.json        the folder, the method and its times of heat, how files become meshes, the
 *                     files and their classes
 *   N.description     the description of file N, from 0
 *   meshes.csv        what was found in each mesh (sim/shapes/describe/corpus.h)
 *
 * It holds descriptions, not features: a method that learns (principal components, vocabularies)
 * learns from the descriptions when the index is opened, the same each time. */
#ifndef SIM_SHAPES_SEARCH_INDEX_H
#define SIM_SHAPES_SEARCH_INDEX_H

#include <stdio.h>

#include "core/base/fault.h"
#include "isotherm/shape_method.h"
#include "sim/shapes/describe/source.h"

struct sim_index_options {
    const char *corpus, *out; /* out NULL: CORPUS.index */
    const char *method;
    int pairs, vertices, smooth, neighbours;
    struct iso_describe_times times; /* of heat; 0: the method's own */
    bool mend, strict;
    int threads;
};

/* Makes or replaces an index. Prints one line. Errors of the manifest, of looking, of describing
 * and of writing; -EINVAL for an unknown method, for neighbours, and for times that the method
 * cannot have; each with a fault. */
int sim_shapes_index(const struct sim_index_options *options, FILE *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* An index that was opened. */
struct sim_index {
    char *corpus; /* the folder as an absolute path */
    const struct iso_shape_method *method;
    struct sim_source_options source;
    int32_t n_pairs;
    struct iso_describe_times times; /* 0: the method's own */
    int32_t n;
    char **file, **class_name; /* [n] */
    struct iso_shape_coder *coder;
    float *feature; /* [n][size of the coder's layout] */
};

/* Opens an index. -EBADMSG if it is damaged or of another format than 1 and 2, -ENOENT, -ENOMEM;
 * each with a fault. */
int sim_index_open(const char *directory, struct sim_index **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_index_close(struct sim_index *index);

#endif
