/* The sensors that were found and can be configured. */
#ifndef CLI_SETUP_CANDIDATES_H
#define CLI_SETUP_CANDIDATES_H

#include "enroll/cli/machine/devices.h"
#include "enroll/cli/setup/sensor_word.h"

enum { CLI_CANDIDATES_MAX = 16 };

struct cli_candidates {
    size_t n;
    struct cli_candidate {
        struct cli_sensor_word sensor;
        char text[352]; /* for people */
    } items[CLI_CANDIDATES_MAX];
};

/* Lists the depth cameras of the kernel (pixel format Z16) and of OpenNI2. The sensor of the
 * board's own file is added if it is a pair of cameras and two or more cameras are found for its
 * driver. */
void cli_candidates_find(const struct cli_setup_places *places, const struct cli_devices *devices,
                         const char *board_text, struct cli_candidates *out);

#endif
