/* Creates directories for results. */
#ifndef SIM_BASE_MAKE_DIRECTORY_H
#define SIM_BASE_MAKE_DIRECTORY_H

#include "core/base/fault.h"

/* Creates the directory unless it exists, and those above it. The errno of mkdir, or -ENOTDIR if
 * something else has that name; each with a fault that names the directory. */
int sim_make_directory(const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Creates a directory that must not exist yet (-EEXIST), so that old and new results are never
 * mixed. */
int sim_make_new_directory(const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
