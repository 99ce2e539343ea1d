#include "sim/lab/eval/site_gallery.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

int sim_option_site(const char *text, void *field)
{
    static const char *const names[] = {"none", "gallery", "split"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (strcmp(text, names[i]) == 0) {
            *(enum sim_site *)field = (enum sim_site)i;
            return 0;
        }
    }
    return -EINVAL;
}

/* Collects the first captures of a person's enrolment; `captures` is room for them. */
static int collect_captures(const struct sim_gallery *gallery, size_t person,
                            const struct iso_metric *metric, struct iso_metric_vector *captures,
                            int *n)
{
    int error = 0;
    *n = 0;
    for (size_t i = 0; i < gallery->n_templates && *n < ISO_SITE_CAPTURES && !error; i++) {
        if (gallery->person[i] != person) {
            continue;
        }
        error = iso_metric_project(metric, gallery->templates[i], &captures[*n]);
        *n += error == 0;
        error = error == -ENODATA ? 0 : error;
    }
    return error;
}

/* Shows all people to the statistics, in the first pass or in the second one. */
static int pass_people(const struct sim_gallery *gallery, const struct iso_metric *metric,
                       bool second, struct iso_metric_vector *captures, struct iso_site *site)
{
    int error = 0, n = 0;
    for (size_t p = 0; p < gallery->n_people && !error; p++) {
        error = collect_captures(gallery, p, metric, captures, &n);
        if (!error && n > 0) {
            error = second ? iso_site_review(site, captures, n)
                           : iso_site_add(site, (int64_t)p, captures, n);
        }
    }
    return error;
}

int sim_site_adapt(const struct sim_gallery *gallery, const struct iso_metric *metric,
                   struct iso_site_metric *out)
{
    struct iso_site *site = NULL;
    struct iso_metric_vector *captures = calloc(ISO_SITE_CAPTURES, sizeof *captures);
    int error = captures ? iso_site_new(metric, &site) : -ENOMEM;
    if (!error) {
        error = pass_people(gallery, metric, false, captures, site);
    }
    if (!error) {
        error = iso_site_find_directions(site);
    }
    if (!error) {
        error = pass_people(gallery, metric, true, captures, site);
    }
    if (!error) {
        error = iso_site_adapt(site, metric, out);
    }
    iso_site_free(site);
    free(captures);
    return error;
}
