/* A whole appliance for a test: a private bus, an empty state directory, a slot for visitors, and
 * the daemon playing it. Its programs are those of the build; its people those of sim/stored. */
#ifndef TEST_APPLIANCE_H
#define TEST_APPLIANCE_H

#include <jansson.h>
#include <stdbool.h>

#include "tests/support/programs/private_bus.h"
#include "tests/support/programs/run.h"

#define APPLIANCE_CORPUS ISOTHERM_SOURCE_DIR "/sim/stored"

/* The command line tool of the build. */
extern const char appliance_isotherm[];

struct appliance {
    struct private_bus bus;
    char *directory; /* of its own, removed at the end */
    char slot[128], configuration[128];
    char bench[128];       /* of the virtual camera; "" without one */
    char people[512];      /* the recordings of those who come: the stored ones, or a copy */
    const char *gap_ms;    /* who is not seen for so long has left */
    const char *settle_ms; /* of appliance_visit(): longer than that */
    struct run daemon;
    bool strict;   /* a recording counts once in ten minutes, as at a door */
    int notify_fd; /* what the daemon tells its service manager */
};

/* Starts the bus. False, with a line that says why, if the machine or the checkout has not what an
 * appliance needs: a dbus-daemon, the stored corpus, the trained model and metric. */
bool appliance_find(void);

/* cmocka set-up and tear-down of a group of tests: *state becomes the appliance, running. */
int appliance_setup(void **state);
int appliance_teardown(void **state);

/* The same with the virtual camera behind OpenNI2's runtime in place of the sensor replay. */
int appliance_setup_openni2(void **state);

/* Writes the daemon's configuration, for its next start. */
void appliance_configure(const struct appliance *appliance);

/* Starts the daemon and waits until it says that it is ready. */
void appliance_start_daemon(struct appliance *appliance);

/* Sends the daemon a signal and waits for its end; its exit code is in daemon.exit. */
void appliance_end_daemon(struct appliance *appliance, int signal);

/* Has somebody stand before the camera; NULL: nobody. */
void appliance_show(const struct appliance *appliance, const char *recording);

struct appliance_result {
    int exit;
    char what[512];             /* the command line */
    char out[32768], err[4096]; /* cut to fit */
};

/* Runs `isotherm --bus ADDRESS WORDS`, words being separated by single blanks. If `recording` is
 * given, that one stands before the camera as soon as the tool says that the camera looks, and
 * leaves with its end. The result is valid until the next run. */
const struct appliance_result *appliance_run(const struct appliance *appliance, const char *words,
                                             const char *recording);

/* Fails the test, saying what it was, how it ended and what it said, unless it ended like that. */
void appliance_expect(const struct appliance_result *result, int exit);

/* The same with --json; the caller releases the document. */
json_t *appliance_run_json(const struct appliance *appliance, const char *words,
                           const char *recording, int exit);

/* Has the people of these rows of the manifest, "p01-v1" and so on up to NULL, come to the door
 * (isotherm-sim visit); visits.csv is then in the appliance's directory. */
const struct appliance_result *appliance_visit(const struct appliance *appliance,
                                               const char *const recordings[]);

#endif
