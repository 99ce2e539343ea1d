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

/* Adds one person with the first captures of the enrolment. `captures` is room for them. */
static int add_person(const struct sim_gallery *gallery, size_t person,
                      const struct iso_metric *metric, struct iso_metric_vector *captures,
                      struct iso_site *site)
{
    int n = 0, error = 0;
    for (size_t i = 0; i < gallery->n_templates && n < ISO_SITE_CAPTURES && !error; i++) {
        if (gallery->person[i] != person) {
            continue;
        }
        error = iso_metric_project(metric, gallery->templates[i], &captures[n]);
        n += error == 0;
        error = error == -ENODATA ? 0 : error;
    }
    return error || n == 0 ? error : iso_site_add(site, captures, n);
}

int sim_site_adapt(const struct sim_gallery *gallery, const struct iso_metric *metric,
                   struct iso_site_metric *out)
{
    struct iso_site *site = NULL;
    struct iso_metric_vector *captures = calloc(ISO_SITE_CAPTURES, sizeof *captures);
    int error = captures ? iso_site_new(metric, &site) : -ENOMEM;
    for (size_t p = 0; p < gallery->n_people && !error; p++) {
        error = add_person(gallery, p, metric, captures, site);
    }
    if (!error) {
        error = iso_site_adapt(site, metric, out);
    }
    iso_site_free(site);
    free(captures);
    return error;
}
