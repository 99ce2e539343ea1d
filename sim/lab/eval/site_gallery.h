/* The metric that an appliance with these people would use: adapted to its enrolled people. */
#ifndef SIM_LAB_EVAL_SITE_GALLERY_H
#define SIM_LAB_EVAL_SITE_GALLERY_H

#include "core/match/site.h"
#include "sim/lab/match/gallery.h"

/* Where the site statistics of an evaluation come from: there are none; the enrolled templates; or
 * half of the people, while the others are judged (site_split.h). */
enum sim_site { SIM_SITE_NONE, SIM_SITE_GALLERY, SIM_SITE_SPLIT };

/* A sim_option_parser of enum sim_site: "none", "gallery" or "split". */
int sim_option_site(const char *text, void *field);

/* Makes the metric that is adapted to the enrolled templates, all of a person as captures of this
 * person. The caller frees it with iso_site_metric_free(). -ENOMEM, and the errors of
 * iso_metric_project and iso_site_adapt. */
int sim_site_adapt(const struct sim_gallery *gallery, const struct iso_metric *metric,
                   struct iso_site_metric *out) __attribute__((warn_unused_result));

#endif
