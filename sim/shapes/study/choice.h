/* Methods and classifiers by the names that a user has given. */
#ifndef SIM_SHAPES_STUDY_CHOICE_H
#define SIM_SHAPES_STUDY_CHOICE_H

#include <stdio.h>

#include "isotherm/classifier.h"
#include "isotherm/shape_method.h"
#include "sim/base/options.h"

enum { SIM_CHOICE_METHODS_MAX = 24, SIM_CHOICE_CLASSIFIERS_MAX = 12 };

struct sim_choice {
    const struct iso_shape_method *method[SIM_CHOICE_METHODS_MAX];
    int n_methods;
    bool all_methods; /* "all": those that need colours only if the corpus has them */
    const struct iso_classifier_ops *classifier[SIM_CHOICE_CLASSIFIERS_MAX];
    int n_classifiers; /* 0: each method's own */
};

/* Reads the names: each text is a name, several with commas, or "all"; no method is "all", no
 * classifier each method's own. Twice the same name counts once. A classifier whose module is
 * missing is left out of "all" with a line on standard error. -EINVAL for an unknown name, with a
 * fault that lists the known ones, and for a named method that none of the chosen classifiers fits;
 * errors of iso_learn_load. */
int sim_choice_read(const struct sim_option_texts *methods,
                    const struct sim_option_texts *classifiers, struct sim_choice *out,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

/* Whether a classifier can compare the features of a method. Features of ISO_NORM_PARTIAL are not
 * vectors. Only the classifier `nn` can compare them, because it uses the method's own norm. */
bool sim_choice_fits(const struct iso_shape_method *method,
                     const struct iso_classifier_ops *classifier);

/* Finds a method by its name. -EINVAL with a fault that lists the known ones. */
int sim_choice_method(const char *name, const struct iso_shape_method **out,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* Removes the methods that need colours, if "all" was given. */
void sim_choice_without_colours(struct sim_choice *choice);

/* Prints the names of all methods and classifiers, a line each, for --help. */
void sim_choice_names(FILE *out);

#endif
