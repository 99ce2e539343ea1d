/* Makes names permanent: a file's name is on the disk only when its directory is. */
#ifndef ISO_DRIVERS_FILE_DIRECTORY_H
#define ISO_DRIVERS_FILE_DIRECTORY_H

#include "core/base/fault.h"

/* Synchronises the directory in which `path` lies. Errors of opening and synchronising it. */
int iso_directory_sync(const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
