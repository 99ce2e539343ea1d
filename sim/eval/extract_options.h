/* The extractor's and the matcher's options on the command line, for experiments. */
#ifndef SIM_EVAL_EXTRACT_OPTIONS_H
#define SIM_EVAL_EXTRACT_OPTIONS_H

#include "core/extract.h"
#include "core/match/distance.h"
#include "sim/options.h"

struct sim_option_set sim_extract_option_set(struct iso_extract_options *options);
struct sim_option_set sim_match_option_set(struct iso_match_options *options);

#endif
