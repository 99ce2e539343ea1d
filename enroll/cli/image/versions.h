/* The versions of all that decides how the appliance behaves: what `isotherm version --all` shows.
 */
#ifndef CLI_IMAGE_VERSIONS_H
#define CLI_IMAGE_VERSIONS_H

#include <jansson.h>
#include <stdio.h>

#include "enroll/cli/image/os_release.h"
#include "enroll/cli/machine/places.h"

enum { CLI_LIBRARIES = 5 };

struct cli_versions {
    char daemon[64]; /* of the isothermd that runs; "": none answers. The caller sets it. */
    struct cli_library {
        const char *name; /* of the project, such as "OpenCV" */
        char version[64]; /* of its package; "": not installed, or there is no list of packages */
    } libraries[CLI_LIBRARIES];
    char kernel[160];             /* its release and build, as uname(1) says */
    struct cli_os_release system; /* with the image */
    char slot[16];                /* from which the image runs; "": this is no image */
    char bundle[64]; /* the update by which the image came into its slot; "": it was flashed, or
                        RAUC does not answer. The caller sets it. */
};

/* Reads everything but what the caller sets, which becomes "". The packages are those of the list
 * of the image, or else those that dpkg-query names. */
void cli_versions_read(const struct cli_image_places *places, struct cli_versions *out);

/* Prints one line for each. */
void cli_versions_print(const struct cli_versions *versions, FILE *out);

/* The same as a document; null stands for "". The caller releases it. NULL if there is no memory.
 */
json_t *cli_versions_json(const struct cli_versions *versions);

#endif
