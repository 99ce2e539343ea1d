/* Where the data files are that the product ships: head model, metric and cohort.
 *
 * An installed program takes them from the data directory that it was installed with. A program
 * that lies in a build tree takes those of its source tree, so that what was just built is also
 * what is tried. Only the place of the executable decides that: the build tree has a symbolic link
 * (ISO_SHIPPED_LINK) to the source's data, and no path of a build is compiled into a program. */
#ifndef ISO_DRIVERS_BASE_SHIPPED_H
#define ISO_DRIVERS_BASE_SHIPPED_H

#include <limits.h>

/* The link in the top directory of a build tree; CMakeLists.txt makes it. */
#define ISO_SHIPPED_LINK "isotherm-build-data"

/* Paths of the files, whether they exist or not. They are worked out once and stay valid; safe to
 * call from several threads. */
const char *iso_shipped_model(void);
const char *iso_shipped_metric(void);
const char *iso_shipped_cohort(void);

/* The directory for a program at this absolute path: that of the link, which is looked for in the
 * directory above the program's and in the two above that, or the installed one. */
void iso_shipped_directory(const char *program, char directory[PATH_MAX]);

#endif
