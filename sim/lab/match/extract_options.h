/* The extractor's and the matcher's options on the command line, for experiments. */
#ifndef SIM_LAB_MATCH_EXTRACT_OPTIONS_H
#define SIM_LAB_MATCH_EXTRACT_OPTIONS_H

#include "core/match/distance.h"
#include "isotherm/extract.h"
#include "sim/base/options.h"

/* The options of the extractor. They are written into `options`. */
struct sim_option_set sim_extract_option_set(struct iso_extract_options *options);

/* The greatest number of threads that may run extractors. With ISO_HEAT_SPECTRAL, whose solver is
 * not reentrant, only 1 is allowed. */
enum { SIM_THREADS_MAX = 64 };

sim_option_parser sim_option_threads; /* int, 1..SIM_THREADS_MAX */

/* One thread for each processor, up to the allowed number. */
int sim_threads_default(enum iso_heat_method heat);

/* -EINVAL with a fault if the number of threads is not allowed. */
int sim_threads_check(int threads, enum iso_heat_method heat, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The options of a comparison by distance. They are written into `options`. */
struct sim_option_set sim_match_option_set(struct iso_match_options *options);

#endif
