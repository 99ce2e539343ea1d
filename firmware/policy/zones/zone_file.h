/* Time zones from the files of the system's tzdata. */
#ifndef ISO_FIRMWARE_POLICY_ZONES_ZONE_FILE_H
#define ISO_FIRMWARE_POLICY_ZONES_ZONE_FILE_H

#include "firmware/policy/zone.h"

/* Where Debian's tzdata has its files. */
#define ISO_ZONE_FOLDER "/usr/share/zoneinfo"

/* Whether the text can be the name of a zone: letters, digits, "_", "+", "-", and "/" between parts
 * that are not empty. So it leads to no other folder. */
bool iso_zone_name_is_right(const char *name);

/* Reads the zone `name` from the folder `context`, a const char * such as ISO_ZONE_FOLDER. The type
 * is that of iso_zone_source.read (policy_document.h). Returns 0, or with a line that names the
 * zone:
 *
 *   -EINVAL   the name is not one of a zone
 *   -ENOENT   there is no such zone
 *   others    of iso_file_read() and iso_zone_read() */
int iso_zone_file_read(void *context, const char *name, struct iso_zone *out,
                       struct iso_fault *fault);

#endif
