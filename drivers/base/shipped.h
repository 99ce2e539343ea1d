/* The paths of the data files of the product: head model, metric and cohort.
 *
 * An installed program uses the data directory with which it was installed. A program in a build
 * tree uses the data of its source tree, so that it is tested with them. Only the place of the
 * executable decides this: the build tree has a symbolic link (ISO_SHIPPED_LINK) to the data of the
 * source tree, and no path of a build is compiled into a program. */
#ifndef ISO_DRIVERS_BASE_SHIPPED_H
#define ISO_DRIVERS_BASE_SHIPPED_H

#include <limits.h>

/* The link in the top directory of a build tree; CMakeLists.txt makes it. */
#define ISO_SHIPPED_LINK "isotherm-build-data"

/* The paths of the files, whether they exist or not. They are determined once and stay valid.
 * Several threads may call these functions. */
const char *iso_shipped_model(void);
const char *iso_shipped_metric(void);
const char *iso_shipped_cohort(void);

/* Writes the data directory for a program at this absolute path. The link is searched for in the
 * three directories above the directory of the program; without a link it is the installed
 * directory. */
void iso_shipped_directory(const char *program, char directory[PATH_MAX]);

#endif
