/* Loads the data files that ship with the product: head model, metric and cohort.
 * drivers/base/shipped.h has their paths.
 *
 * The daemon does not use this loader: each of its recognition methods reads its own data and
 * refuses files made for another algorithm. An evaluation may combine any files. */
#ifndef SIM_BASE_DATA_FILE_H
#define SIM_BASE_DATA_FILE_H

#include "core/base/fault.h"
#include "core/match/cohort.h"
#include "isotherm/head_model.h"
#include "isotherm/metric.h"

/* Reads a head model. -EBADMSG if the file is damaged, -EFBIG, -ENOMEM or the errno of open and
 * read, each with a fault "path: what is wrong". Free with iso_head_model_free. */
int sim_head_model_load(const char *path, struct iso_head_model **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads a metric in the same way. Free with iso_metric_free. */
int sim_metric_load(const char *path, struct iso_metric **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads a cohort in the same way. Free with iso_cohort_free. */
int sim_cohort_load(const char *path, struct iso_cohort **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
