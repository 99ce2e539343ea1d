/* The metric that an appliance with these people would use: adapted to its enrolled people. */
#ifndef SIM_LAB_EVAL_SITE_GALLERY_H
#define SIM_LAB_EVAL_SITE_GALLERY_H

#include "core/match/site.h"
#include "sim/lab/match/gallery.h"
#include "sim/lab/match/match.h"

/* Where the site statistics of an evaluation come from: there are none; the enrolled templates; of
 * these only the ones of the sensor that sees the visitors; or half of the people, while the others
 * are judged (site_split.h). */
enum sim_site { SIM_SITE_NONE, SIM_SITE_GALLERY, SIM_SITE_SENSOR, SIM_SITE_SPLIT };

/* A sim_option_parser of enum sim_site: "none", "gallery", "sensor" or "split". */
int sim_option_site(const char *text, void *field);

/* The kind of sensor of the first search; NULL if there is no search. It belongs to the
 * acquisition. */
const char *sim_site_searching_sensor(const struct sim_corpus *corpus,
                                      const struct sim_acquisition *acquisition);

/* Makes the metric that is adapted to the enrolled templates, all of a person as captures of this
 * person; if the gallery names a teaching sensor, to the templates of that sensor alone. The caller
 * frees it with iso_site_metric_free(). -ENOMEM, and the errors of iso_metric_project and
 * iso_site_adapt. */
int sim_site_adapt(const struct sim_gallery *gallery, const struct iso_metric *metric,
                   struct iso_site_metric *out) __attribute__((warn_unused_result));

/* Compares the visitors who are enrolled with the other people as if the visitors were strangers.
 * If the site statistics contain a visitor's own captures, the metric distinguishes this visitor
 * from the others better than it distinguishes a stranger. The false match rate of these
 * comparisons would be too low.
 *
 * Sets matches->stranger_score: for each person with searches, the metric is adapted to the
 * templates of all others, and these searches are compared with the others only. The scores are the
 * same as if the person had never been enrolled. The place of the person itself, and searches of
 * people who are not enrolled, have -INFINITY. `metric` is the shipped one; the other arguments are
 * those of sim_match(), which made the matches. The time grows with the square of the number of
 * people: some seconds for 100. The errors of sim_site_adapt and sim_match. */
int sim_site_judge_strangers(const struct sim_corpus *corpus, struct sim_acquisition *acquisition,
                             const struct sim_gallery *gallery, const struct iso_metric *metric,
                             const struct sim_scoring *scoring, int threads,
                             struct sim_matches *matches) __attribute__((warn_unused_result));

#endif
