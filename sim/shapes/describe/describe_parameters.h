/* Writes the file of parameters that lies beside the arrays of a shape. Internal to
 * sim/shapes/describe. */
#ifndef SIM_SHAPES_DESCRIBE_DESCRIBE_PARAMETERS_H
#define SIM_SHAPES_DESCRIBE_DESCRIBE_PARAMETERS_H

#include "sim/shapes/describe/describe.h"

enum { SIM_DESCRIBE_MAX = 64 };

/* What is wanted. */
struct sim_describe_choice {
    const struct sim_quantity *quantity[SIM_DESCRIBE_MAX];
    const struct iso_shape_method *method[SIM_DESCRIBE_MAX];
    int n_quantities, n_methods;
    bool colours;          /* one of the methods needs a mesh with colours */
    bool as_colours_allow; /* a mesh without colours is described without these methods */
};

/* A mesh that was described. All are borrowed. */
struct sim_describe_subject {
    const char *path, *directory;
    struct sim_source_look look;
    const struct iso_shape *shape;
    struct sim_arrays *arrays;
};

/* Writes parameters.json. Errors of sim_json_file. */
int sim_describe_parameters(const struct sim_describe_options *options,
                            enum sim_array_format format,
                            const struct sim_describe_subject *subject, const char *path,
                            struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
