/* Loads the trained data files of the product: head model, metric and cohort. They can be the files
 * that are installed with it (drivers/base/shipped.h has their paths) or others. The loader does
 * not compare the algorithms of two files: an evaluation may combine any files, and the recognition
 * methods of the daemon refuse a file that was made for another algorithm. */
#ifndef ISO_DRIVERS_MODEL_MODEL_FILE_H
#define ISO_DRIVERS_MODEL_MODEL_FILE_H

#include "core/match/cohort.h"
#include "isotherm/fault.h"
#include "isotherm/head_model.h"
#include "isotherm/metric.h"

/* Loads a head model; the caller frees it with iso_head_model_free(). The errors of
 * iso_data_file_read (drivers/file/data_file.h), -EBADMSG if the file is damaged, -ENOMEM; each
 * with a fault that names the file. */
int iso_head_model_load(const char *path, struct iso_head_model **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Loads a metric in the same way; the caller frees it with iso_metric_free(). */
int iso_metric_load(const char *path, struct iso_metric **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Loads a cohort in the same way; the caller frees it with iso_cohort_free(). */
int iso_cohort_load(const char *path, struct iso_cohort **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
