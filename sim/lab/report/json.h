/* Parts of summary.json, for all commands that write one. */
#ifndef SIM_LAB_REPORT_JSON_H
#define SIM_LAB_REPORT_JSON_H

#include <jansson.h>

#include "sim/lab/eval/landmark_error.h"
#include "sim/lab/match/latency.h"
#include "sim/lab/measure/rate.h"

/* These functions return new references, or NULL if memory runs out. json_pack() of a NULL value
 * returns NULL as well, which sim_json_file() reports as -ENOMEM. json_object_set_new() and
 * json_array_append_new() fail for NULL, and the value is then missing. */

/* A number, or null for infinities and NaN, which JSON does not have. */
json_t *sim_json_number(double value);

/* Value, Wilson's interval, events and trials. */
json_t *sim_json_rate(struct sim_rate rate);

/* The same with the exact interval. */
json_t *sim_json_exact_rate(struct sim_rate rate);

/* The options of the extractor. */
json_t *sim_json_extract(const struct iso_extract_options *options);

/* The number of times, their median and their 95th percentile in milliseconds. */
json_t *sim_json_latency(struct sim_latency latency);

/* One object for each landmark that was measured at least once, and one for all together. */
json_t *sim_json_landmarks(const struct sim_landmark_error errors[ISO_LANDMARKS + 1]);

/* Writes a document, its real numbers with eight significant digits, and releases the reference.
 * -ENOMEM for NULL, -EIO; each with a fault. */
int sim_json_file(json_t *document, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The same with 17 digits: a number that is read again is the same to the bit. */
int sim_json_file_exact(json_t *document, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
