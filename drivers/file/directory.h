/* Makes the names of files permanent: a new or changed name is on the disk only after its directory
 * has been synchronised. */
#ifndef ISO_DRIVERS_FILE_DIRECTORY_H
#define ISO_DRIVERS_FILE_DIRECTORY_H

#include "core/base/fault.h"

/* Synchronises the directory that contains `path`. The errno of opening the directory, the errors
 * of storage (storage_fault.h), -ENAMETOOLONG. */
int iso_directory_sync(const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
