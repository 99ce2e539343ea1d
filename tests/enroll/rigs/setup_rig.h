/* A machine for tests of `isotherm setup`: its places in a scratch directory, a private bus with a
 * scripted service manager and a scripted daemon, and the real isothermd to check configurations.
 */
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
    struct cli_fault fault;   /* of the last run */
    char *said;               /* what the last run said */
    const char *calls;        /* of the service manager */
    const char *daemon_calls; /* of the daemon */
};

/* Starts the bus that all tests of a program share; false if the program is to be skipped. */
bool setup_rig_find_bus(void);
int setup_rig_stop_bus(void **state);

/* cmocka set-up and tear-down: *state becomes a struct setup_rig. There is no configuration yet, no
 * camera, and no board is recognised. */
int setup_rig_setup(void **state);
int setup_rig_teardown(void **state);

/* A full name in the rig's directory. */
const char *setup_rig_path(const char *name);

/* What `isothermd --list-devices` prints from now on. */
void setup_rig_set_devices(const char *lines);

/* Puts both on the bus; NULL: it stays away. */
void setup_rig_begin(struct setup_rig *rig, const struct fake_manager_script *manager,
                     const struct fake_script *daemon);

/* Takes both from the bus again; rig->calls are the manager's, rig->daemon_calls the
 * daemon's. */
void setup_rig_end(struct setup_rig *rig);

/* Does what the program does between these two, without a terminal. */
enum cli_exit setup_rig_run(struct setup_rig *rig, const struct cli_setup_wish *wish,
                            const struct fake_manager_script *manager,
                            const struct fake_script *daemon);

/* A terminal at which the program runs in a process of its own. */
struct setup_terminal {
    pid_t pid;
    int fd;
    char text[64 * 1024]; /* what has come so far */
    size_t length, asked; /* asked: up to where questions have been answered */
};

void setup_rig_open(struct setup_rig *rig, const struct cli_setup_wish *wish,
                    struct setup_terminal *terminal);

/* Waits for a question, in what has come since the last answer, and answers it. */
void setup_rig_answer(struct setup_terminal *terminal, const char *question, const char *answer);

/* Waits for the end; returns the exit code. */
int setup_rig_close(struct setup_terminal *terminal);

/* A configuration of before, with comments; and that it is there. */
extern const char setup_rig_old_text[];
void setup_rig_write_old(void);

/* What `isothermd --list-devices` prints of one camera. */
extern const char setup_rig_one_camera[];

/* Fails unless the part is in the text. */
void setup_rig_expect_in(const char *text, const char *part);

#define ON_A_RIG(test) cmocka_unit_test_setup_teardown(test, setup_rig_setup, setup_rig_teardown)

/* A PNG of two by two pixels, and its size. */
const char *setup_rig_png(size_t *size);

/* How many files there are beside the configuration, which counts, too. */
size_t setup_rig_count_files(void);

/* Fails unless the configuration has this text; NULL: unless there is none. */
void setup_rig_expect_config(const char *text);

#endif
