/* Parts of summary.json, for every command that writes one. */
#ifndef SIM_LAB_REPORT_JSON_H
#define SIM_LAB_REPORT_JSON_H

#include <jansson.h>

#include "sim/lab/eval/landmark_error.h"
#include "sim/lab/match/latency.h"
#include "sim/lab/measure/rate.h"

/* New references. Out of memory shows as a NULL that Jansson's setters refuse; sim_json_file then
 * fails. */

/* null for what JSON has no word for: infinities and NaN. */
json_t *sim_json_number(double value);

/* Value, Wilson's interval, events and trials. */
json_t *sim_json_rate(struct sim_rate rate);

/* The same with the exact interval. */
json_t *sim_json_exact_rate(struct sim_rate rate);

json_t *sim_json_extract(const struct iso_extract_options *options);
json_t *sim_json_latency(struct sim_latency latency);

/* An object a landmark, those that were never measured left out. */
json_t *sim_json_landmarks(const struct sim_landmark_error errors[ISO_LANDMARKS + 1]);

/* Writes a document and gives up the reference. -ENOMEM for NULL, -EIO. */
int sim_json_file(json_t *document, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
