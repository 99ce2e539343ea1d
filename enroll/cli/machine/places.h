/* The paths that `isotherm setup`, `isotherm web`, `isotherm update`, `isotherm version` and
 * `isotherm factory-reset` use. The installed program has one set of them; tests have their own. */
#ifndef CLI_MACHINE_PLACES_H
#define CLI_MACHINE_PLACES_H

#include <limits.h>
#include <stdbool.h>

#include "enroll/cli/client/daemon.h"

struct cli_setup_places {
    const char *config;     /* the file to write */
    const char *boards;     /* a folder with one folder a board: isotherm.conf and board.json */
    const char *cameras;    /* a folder with descriptions of depth cameras: NAME.ini */
    const char *daemon;     /* the program isothermd */
    const char *sys;        /* "/sys": the connected devices and the kind of machine */
    const char *dev;        /* "/dev": names of cameras that do not change */
    const char *unit;       /* the name of the daemon's unit */
    struct cli_bus manager; /* the bus of the service manager */
    bool root;              /* only root may write the configuration */
    int daemon_wait_s;      /* longest wait for the daemon on the bus, once its unit is active */
};

struct cli_web_places {
    const char *program;   /* isotherm-web */
    const char *systemctl; /* knows where the web server listens */
    bool root;             /* only root may read the state of the web server */
};

struct cli_image_places {
    const char *os_release; /* which image runs */
    const char *slot;       /* from which slot it runs: SLOT=a */
    const char *trial;      /* whether its version is on trial: TRIAL=yes or TRIAL=no */
    const char *packages;   /* the list of the packages of the image */
    const char *dpkg_query; /* knows the packages where there is no such list */
};

struct cli_reset_places {
    const char *daemon;    /* the program isothermd, which deletes the state */
    const char *config;    /* its configuration */
    const char *systemctl; /* stops and starts the services */
    bool root;             /* only root may delete the state */
};

/* Writes the path of the program that reads files of policies (policy/policy_reader.h). It is at
 * ../lib/isotherm from the folder of this program, in a build tree as in an installed one. */
void cli_places_policy_reader(char path[PATH_MAX]);

/* The paths of the installed program. */
extern const struct cli_web_places cli_web_installed;
extern const struct cli_setup_places cli_setup_installed;
extern const struct cli_image_places cli_image_installed;
extern const struct cli_reset_places cli_reset_installed;

#endif
