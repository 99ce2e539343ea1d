/* The version that runs, the slots and the work of RAUC, as text or as a document. */
#ifndef CLI_IMAGE_UPDATE_TEXT_H
#define CLI_IMAGE_UPDATE_TEXT_H

#include <jansson.h>
#include <stdio.h>

#include "enroll/cli/image/installer.h"
#include "enroll/cli/image/os_release.h"

struct cli_update_view {
    struct cli_os_release running;
    const struct cli_installer_state *state;
    bool busy;              /* RAUC is at work, and the slots are not known */
    struct cli_slots slots; /* empty while RAUC is at work */
    const char *trial;      /* "yes": the boot loader may still leave the running version; "no": it
                               was found to be good; "": not known; NULL: not asked. RAUC calls a
                               slot good in either case. */
};

/* Prints one line for each thing. */
void cli_update_print(const struct cli_update_view *view, FILE *out);

/* {"image", "board", "version", "operation", "percent", "slots": [{"slot", "version", "running",
 * "good", "next"}]}; a version that is not known is null. If it was asked, also "proven": true, or
 * false while the running version is on trial, or null. The caller releases it. NULL if there is no
 * memory. */
json_t *cli_update_json(const struct cli_update_view *view);

/* The slot that starts next and does not run; NULL if there is none. It belongs to `slots`. */
const struct cli_slot *cli_update_waiting(const struct cli_slots *slots);

#endif
