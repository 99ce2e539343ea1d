/* A recognition method compares the template of a face with the templates of people.
 *
 * A frame becomes a template (core/extract), which describes the face: the isotherms around its
 * landmarks and the surface of its upper part (isotherm/template.h). A method gives each person of
 * the gallery a score for that template. The key `method` of [match] names the method of an
 * appliance.
 *
 * A method is a table of functions, one line in methods.def and one line in the build; ADDING.md
 * describes how to add one. One thread uses an open method. */
#ifndef ISO_FIRMWARE_RECOGNISE_METHOD_METHOD_H
#define ISO_FIRMWARE_RECOGNISE_METHOD_METHOD_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "core/match/search.h"
#include "firmware/gallery/candidate_list.h"

/* Arguments for opening a method. They need not outlive the call. */
struct iso_method_setup {
    const char *data_path;          /* the file with its trained data; "" if it needs none */
    uint32_t algorithm;             /* algorithm of every template that it will receive */
    struct iso_match_options match; /* for a method that registers templates */
};

struct iso_method_ops {
    const char *name; /* the name in methods.def */

    /* The key of [model] that names the data file, and the installed file; both NULL if the method
     * needs no file. */
    const char *data_key;
    const char *(*installed_data)(void);

    /* Whether one of 10^s similar strangers reaches a score of s (isotherm/metric.h), so that a
     * security level of [decision] gives the threshold. Otherwise the site has to set `threshold`.
     */
    bool calibrated;

    /* Reads the data file. -ENOENT and other errors of reading it, -EBADMSG it is damaged, -EINVAL
     * it was made for templates of another algorithm, -ENOMEM; each with a fault. */
    int (*open)(const struct iso_method_setup *setup, void **self, struct iso_fault *fault);

    /* Finds the best people among these for a probe, by falling score, with one hit for each
     * person. Writes at most `capacity` hits; *n_hits is their number. Nothing is allocated, and
     * the working memory is wiped at the end. `among->index` is set only for a method that has
     * `metric`. -ENODATA the probe has too few points for a comparison, -EINVAL a template is of
     * another algorithm; errors of opening templates. */
    int (*search)(void *self, const struct iso_candidate_list *among,
                  const struct iso_template *probe, struct iso_search_hit *hits, int capacity,
                  int *n_hits);

    /* OPTIONAL: the metric with which the gallery makes its index of people, so that their
     * templates need not stay in memory. */
    const struct iso_metric *(*metric)(const void *self);

    /* OPTIONAL: wipes the data of people that the method keeps between searches, because a person
     * was removed. */
    void (*forget)(void *self);

    /* Wipes and frees everything. */
    void (*close)(void *self);
};

/* The methods in the order of methods.def: the value of an ISO_CONFIG_CHOICE. */
enum iso_method {
#define METHOD(name, about) ISO_METHOD_##name,
#include "firmware/recognise/method/methods.def"
#undef METHOD
    ISO_METHODS
};

#define METHOD(name, about) extern const struct iso_method_ops iso_method_##name##_ops;
#include "firmware/recognise/method/methods.def"
#undef METHOD

/* The operations of a method, which must be one of the enumeration. */
const struct iso_method_ops *iso_method_at(enum iso_method method);

/* Checks that a data file was made for the templates that the method will receive. -EINVAL with a
 * fault that names both algorithms. */
int iso_method_check_algorithm(const struct iso_method_setup *setup, uint32_t algorithm,
                               struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
