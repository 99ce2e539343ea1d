/* Joining a directory and a file's name. */
#ifndef ISO_DRIVERS_BASE_PATH_H
#define ISO_DRIVERS_BASE_PATH_H

#include <limits.h>

#include "core/base/fault.h"

/* DIRECTORY/FILE. -ENAMETOOLONG with a fault. */
int iso_path_join(const char *directory, const char *file, char path[PATH_MAX],
                  struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
