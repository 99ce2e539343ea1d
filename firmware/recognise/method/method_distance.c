/* The method `distance`: the trimmed distance of the isotherms after registration, as Abdelrahman
 * (2013, chapter 6) compares them, normalised by a cohort (core/match/distance.h, cohort.h). */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/shipped.h"
#include "drivers/model/model_file.h"
#include "firmware/recognise/method/method.h"

struct by_distance {
    struct iso_cohort *cohort;
    struct iso_match_options match;
    struct iso_icp_workspace registration;
};

static void distance_close(void *self)
{
    struct by_distance *method = self;
    iso_cohort_free(method->cohort);
    free(method);
}

static int load(struct by_distance *method, const struct iso_method_setup *setup,
                struct iso_fault *fault)
{
    const int error = iso_cohort_load(setup->data_path, &method->cohort, fault);
    return error ? error
                 : iso_method_check_algorithm(setup, iso_cohort_algorithm(method->cohort), fault);
}

static int distance_open(const struct iso_method_setup *setup, void **self, struct iso_fault *fault)
{
    struct by_distance *method = calloc(1, sizeof *method);
    if (!method) {
        return iso_fault_set(fault, -ENOMEM, "method distance: out of memory");
    }
    method->match = setup->match;
    const int error = load(method, setup, fault);
    if (error) {
        distance_close(method);
        return error;
    }
    *self = method;
    return 0;
}

static int distance_search(void *self, const struct iso_candidate_list *among,
                           const struct iso_template *probe, struct iso_search_hit *hits,
                           int capacity, int *n_hits)
{
    struct by_distance *method = self;
    const int error = iso_search(&method->registration, among->entries, among->n_entries, probe,
                                 method->cohort, &method->match, hits, capacity, n_hits);
    explicit_bzero(&method->registration, sizeof method->registration);
    return error;
}

const struct iso_method_ops iso_method_distance_ops = {
    .name = "distance",
    .data_key = "cohort",
    .installed_data = iso_shipped_cohort,
    .open = distance_open,
    .search = distance_search,
    .close = distance_close,
};
