/* Writes result files. */
#ifndef SIM_BASE_RESULT_FILE_H
#define SIM_BASE_RESULT_FILE_H

#include <stdio.h>

#include "core/base/fault.h"

/* A function that writes the contents of a file. */
typedef void sim_result_writer(const void *context, FILE *out);

/* Writes DIRECTORY/NAME and replaces an existing file. -ENAMETOOLONG, -EIO or the errno of
 * opening it, each with a fault that names the file. */
int sim_result_file(const char *directory, const char *name, sim_result_writer *writer,
                    const void *context, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
