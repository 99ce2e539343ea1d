/* Parts of summary.json, for all commands that write one. */
#ifndef SIM_LAB_REPORT_JSON_H
#define SIM_LAB_REPORT_JSON_H

#include <jansson.h>

#include "sim/lab/eval/landmark_error.h"
#include "sim/lab/match/latency.h"
#include "sim/lab/measure/rate.h"

/* They return new references. If memory runs out they return NULL, which Jansson's setters
 * refuse; sim_json_file then fails. */

/* A number, or null for infinities and NaN, which JSON does not have. */
json_t *sim_json_number(double value);

/* Value, Wilson's interval, events and trials. */
json_t *sim_json_rate(struct sim_rate rate);

/* The same with the exact interval. */
json_t *sim_json_exact_rate(struct sim_rate rate);

json_t *sim_json_extract(const struct iso_extract_options *options);
json_t *sim_json_latency(struct sim_latency latency);

/* One object for each landmark that was measured at least once. */
json_t *sim_json_landmarks(const struct sim_landmark_error errors[ISO_LANDMARKS + 1]);

/* Writes a document and releases the reference. -ENOMEM for NULL, -EIO. */
int sim_json_file(json_t *document, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
