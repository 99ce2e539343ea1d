/* Makes the directories that results go to. */
#ifndef SIM_BASE_MAKE_DIRECTORY_H
#define SIM_BASE_MAKE_DIRECTORY_H

#include "core/base/fault.h"

/* Makes the directory unless it is there already. The errno of mkdir, with a fault that names it.
 */
int sim_make_directory(const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Makes a directory that must not exist yet, so that no older results are mixed with new ones. */
int sim_make_new_directory(const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
