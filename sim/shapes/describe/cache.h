/* Descriptions that an earlier run has made, by the content of the mesh's file and by everything
 * that the description depends on: a file KEY.description each. */
#ifndef SIM_SHAPES_DESCRIBE_CACHE_H
#define SIM_SHAPES_DESCRIBE_CACHE_H

#include "isotherm/shape_method.h"
#include "sim/shapes/describe/source.h"

/* To be raised when a description by some method changes; other releases have other keys anyway. */
enum { SIM_CACHE_REVISION = 2 };

enum { SIM_CACHE_NAME_SIZE = 64 };

/* What identifies a mesh and its treatment. */
struct sim_cache_subject {
    uint8_t content[32]; /* BLAKE2b of the file, or of both of TOSCA's files */
    const char *name;    /* of the file in its corpus: distortions depend on it */
    const struct sim_source_options *source;
    int32_t n_pairs;
    bool colours;                    /* whether the shape is made with its colours */
    struct iso_describe_times times; /* of heat, as they were chosen */
};

/* The hash of a mesh's file. Errors of iso_file_read(), with a fault. */
int sim_cache_hash(const char *path, uint8_t content[32], struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The name of the file in a cache for a description by a method. */
void sim_cache_name(const struct sim_cache_subject *subject, const struct iso_shape_method *method,
                    char name[SIM_CACHE_NAME_SIZE]);

#endif
