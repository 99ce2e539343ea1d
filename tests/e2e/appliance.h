/* A whole appliance for a test: a private bus, an empty state directory, a slot for the recording
 * of a visitor, and the daemon, which plays the slot. The programs are those of the build, and the
 * people are those of sim/stored. */
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
    char *directory; /* the state directory, removed at the end */
    char slot[128], configuration[128];
    char bench[128];       /* directory of the virtual camera; "" without one */
    char people[512];      /* the directory of the visitors' recordings: sim/stored, or a copy */
    const char *gap_ms;    /* a visit ends when no face was seen for this time */
    const char *settle_ms; /* pause between two visits of appliance_visit(), longer than gap_ms */
    const char *keys;      /* more sections of the configuration; "" */
    struct run daemon;
    bool strict;   /* a frame counts once in ten minutes, as at a door */
    int notify_fd; /* the daemon's messages to its service manager */
};

/* Starts the bus. If something that an appliance needs is missing, it prints what is missing and
 * returns false: a dbus-daemon, the stored corpus, or the trained model and metric. */
bool appliance_find(void);

/* cmocka set-up and tear-down of a group of tests: *state becomes the running appliance. */
int appliance_setup(void **state);
int appliance_teardown(void **state);

/* Like appliance_setup, with the virtual camera behind OpenNI2's runtime in place of the replay of
 * recordings. */
int appliance_setup_openni2(void **state);

/* Writes the daemon's configuration, which it reads at its next start. */
void appliance_configure(const struct appliance *appliance);

/* Starts the daemon and waits until it says that it is ready. */
void appliance_start_daemon(struct appliance *appliance);

/* Sends a signal to the daemon and waits for its end; its exit code is in daemon.exit. */
void appliance_end_daemon(struct appliance *appliance, int signal);

/* Puts a recording before the camera; NULL: nothing. */
void appliance_show(const struct appliance *appliance, const char *recording);

struct appliance_result {
    int exit;
    char what[512];             /* the command line */
    char out[32768], err[4096]; /* cut to fit */
};

/* Runs `isotherm --bus ADDRESS WORDS`, where single blanks separate the words. `recording` (NULL:
 * none) is before the camera from the moment at which the tool asks the person to look straight at
 * the camera until the end of the tool. The result is valid until the next run. */
const struct appliance_result *appliance_run(const struct appliance *appliance, const char *words,
                                             const char *recording);

/* Fails the test unless the command ended with this code. The message has the command, its end and
 * its last line. */
void appliance_expect(const struct appliance_result *result, int exit);

/* Like appliance_run with --json. It expects this exit code. The caller releases the document. */
json_t *appliance_run_json(const struct appliance *appliance, const char *words,
                           const char *recording, int exit);

/* Plays the visits of these rows of the manifest, "p01-v1" and so on up to NULL, to the daemon
 * (isotherm-sim visit). Afterwards visits.csv is in the appliance's directory. The result is valid
 * until the next run. */
const struct appliance_result *appliance_visit(const struct appliance *appliance,
                                               const char *const recordings[]);

#endif
