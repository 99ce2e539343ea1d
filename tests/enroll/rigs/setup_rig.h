/* A machine for tests of `isotherm setup`: a scratch directory with its files, a private bus with a
 * scripted service manager and a scripted daemon, and the real isothermd that checks
 * configurations. */
#ifndef TEST_SETUP_RIG_H
#define TEST_SETUP_RIG_H

#include "enroll/cli/setup/setup.h"
#include "tests/enroll/rigs/fake_daemon.h"
#include "tests/enroll/rigs/fake_manager.h"

struct setup_rig {
    struct cli_setup_places places;
    struct fake_daemon daemon;
    struct fake_manager manager;
    bool has_daemon, has_manager;
    struct cli_fault fault;   /* the fault of the last run */
    char *said;               /* the output of the last run */
    const char *calls;        /* the calls to the service manager */
    const char *daemon_calls; /* the calls to the daemon */
};

/* Starts the bus that all tests of a program share. Returns false if the program has to skip its
 * tests. */
bool setup_rig_find_bus(void);
int setup_rig_stop_bus(void **state);

/* cmocka set-up and tear-down: *state becomes a struct setup_rig. At first the machine has no
 * configuration and no camera, and its board is unknown. */
int setup_rig_setup(void **state);
int setup_rig_teardown(void **state);

/* Returns the full path of a name in the rig's directory. */
const char *setup_rig_path(const char *name);

/* Sets what `isothermd --list-devices` prints from now on. */
void setup_rig_set_devices(const char *lines);

/* Puts the service manager and the daemon on the bus. If one of them is NULL, it stays away. */
void setup_rig_begin(struct setup_rig *rig, const struct fake_manager_script *manager,
                     const struct fake_script *daemon);

/* Takes both from the bus again. rig->calls has the calls to the manager, rig->daemon_calls those
 * to the daemon. */
void setup_rig_end(struct setup_rig *rig);

/* Runs the set-up as the program does, without a terminal, and returns its exit code. The service
 * manager and the daemon are on the bus meanwhile: it calls setup_rig_begin and setup_rig_end. */
enum cli_exit setup_rig_run(struct setup_rig *rig, const struct cli_setup_wish *wish,
                            const struct fake_manager_script *manager,
                            const struct fake_script *daemon);

/* A terminal. The program runs on it in a process of its own. */
struct setup_terminal {
    pid_t pid;
    int fd;
    char text[64 * 1024]; /* the output so far */
    size_t length, asked; /* asked: length of the output whose questions were answered */
};

/* Starts the set-up on a terminal of 80 columns. Call setup_rig_begin before it if the service
 * manager or the daemon has to be on the bus. */
void setup_rig_open(struct setup_rig *rig, const struct cli_setup_wish *wish,
                    struct setup_terminal *terminal);

/* Waits for a question in the output since the last answer, and answers it. */
void setup_rig_answer(struct setup_terminal *terminal, const char *question, const char *answer);

/* Waits for the end of the program. Returns its exit code, or 1000 + the signal. */
int setup_rig_close(struct setup_terminal *terminal);

/* An earlier configuration with comments. The function writes it. */
extern const char setup_rig_old_text[];
void setup_rig_write_old(void);

/* The output of `isothermd --list-devices` for one camera. */
extern const char setup_rig_one_camera[];

/* Fails unless `text` contains the part. */
void setup_rig_expect_in(const char *text, const char *part);

#define ON_A_RIG(test) cmocka_unit_test_setup_teardown(test, setup_rig_setup, setup_rig_teardown)

/* Returns a PNG of two by two pixels, and its size. */
const char *setup_rig_png(size_t *size);

/* Counts the files in the directory of the configuration. The configuration counts, too. */
size_t setup_rig_count_files(void);

/* Fails unless the configuration has this text. NULL: fails if there is a configuration. */
void setup_rig_expect_config(const char *text);

#endif
