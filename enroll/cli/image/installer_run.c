/* The installation of an update by RAUC. */
#include "enroll/cli/image/installer.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "drivers/terminal/progress.h"
#include "enroll/cli/image/installer_inner.h"
#include "enroll/cli/machine/interrupt.h"

/* RAUC reports nothing while it writes one part of the bundle. */
enum { SILENCE_S = 10 * 60, SLICE_US = 200 * 1000 };

/* RAUC has no code for what its handler refuses; it repeats the exit code in this sentence. */
#define HANDLER_ENDED "Pre-install handler error: Child process exited with code "

/* An installation that goes on. */
struct work {
    struct cli_installer *installer;
    struct iso_progress *progress;
    bool ended, gone; /* RAUC has finished; RAUC has left the bus */
    int32_t result;   /* once it has ended; 0: the update is installed */
    bool heard;       /* RAUC has reported something since this was set to false */
};

static int on_change(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    struct work *work = context;
    struct cli_installer_state *state = &work->installer->state;
    const char *interface;

    (void)error;
    work->heard = true;
    if (sd_bus_message_read(signal, "s", &interface) >= 0 &&
        strcmp(interface, CLI_RAUC_INTERFACE) == 0 && cli_rauc_read_state(signal, state) >= 0 &&
        state->percent >= 0 && state->percent <= 100) {
        iso_progress_set(work->progress, (uint64_t)state->percent, 100);
    }
    return 0;
}

static int on_completed(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    struct work *work = context;

    (void)error;
    if (sd_bus_message_read(signal, "i", &work->result) >= 0) {
        work->ended = true;
    }
    return 0;
}

static int on_owner_changed(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    struct work *work = context;

    (void)signal, (void)error;
    work->gone = true;
    return 0;
}

/* The matches name RAUC's connection and not its service: any client may send a signal directly to
 * this one, and sd-bus itself compares only the name of a connection. */
static int subscribe(struct work *work, sd_bus_slot *slots[3])
{
    sd_bus *bus = work->installer->bus;
    const char *owner = work->installer->owner;
    int r = sd_bus_match_signal(bus, &slots[0], owner, CLI_RAUC_PATH,
                                "org.freedesktop.DBus.Properties", "PropertiesChanged", on_change,
                                work);

    if (r >= 0) {
        r = sd_bus_match_signal(bus, &slots[1], owner, CLI_RAUC_PATH, CLI_RAUC_INTERFACE,
                                "Completed", on_completed, work);
    }
    if (r >= 0) {
        r = sd_bus_add_match(bus, &slots[2],
                             "type='signal',sender='org.freedesktop.DBus',"
                             "path='/org/freedesktop/DBus',interface='org.freedesktop.DBus',"
                             "member='NameOwnerChanged',arg0='" CLI_RAUC "'",
                             on_owner_changed, work);
    }
    return r;
}

static int64_t now_s(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec;
}

/* Returns 0 when RAUC has finished, -EINTR, -ECONNRESET if RAUC is gone, -ETIMEDOUT, or the error
 * of the bus. */
static int wait_for_end(struct work *work)
{
    sd_bus *bus = work->installer->bus;
    int64_t deadline_s = now_s() + SILENCE_S;

    while (!work->ended) {
        if (cli_interrupted()) {
            return -EINTR;
        }
        if (work->gone) {
            return -ECONNRESET;
        }
        if (work->heard) {
            work->heard = false;
            deadline_s = now_s() + SILENCE_S;
        }
        if (now_s() >= deadline_s) {
            return -ETIMEDOUT;
        }
        int r = sd_bus_process(bus, NULL);
        r = r == 0 ? sd_bus_wait(bus, SLICE_US) : r;
        if (r < 0 && r != -EINTR) {
            return r;
        }
    }
    return 0;
}

static enum cli_exit no_end(int error, struct cli_fault *fault)
{
    switch (error) {
    case -EINTR:
        return cli_fault_set(fault, CLI_EXIT_INTERRUPTED, "interrupted",
                             "RAUC goes on with the update; isotherm update shows how far it is");
    case -ETIMEDOUT:
        return cli_fault_set(fault, CLI_EXIT_TIMED_OUT, "no-reply",
                             "RAUC has reported nothing for ten minutes");
    default:
        return cli_fault_set(fault, CLI_EXIT_FAULT, "update-fault",
                             "RAUC has ended in the middle of the update (journalctl --unit=rauc): "
                             "%s",
                             strerror(-error));
    }
}

/* Why RAUC has refused the bundle. The exit codes are those of board/image/programs/check-update.
 */
static enum cli_exit refusal(struct cli_installer *installer, const char *path,
                             struct cli_fault *fault)
{
    const char *said = installer->state.error;

    if (strcmp(said, HANDLER_ENDED "3") == 0) {
        return cli_fault_set(fault, CLI_EXIT_NO, "not-newer",
                             "%.160s: it is not newer than the running version", path);
    }
    if (strcmp(said, HANDLER_ENDED "4") == 0) {
        return cli_fault_set(fault, CLI_EXIT_NO, "other-board", "%.160s: it is for another board",
                             path);
    }
    if (strcmp(said, HANDLER_ENDED "5") == 0) {
        return cli_fault_set(
            fault, CLI_EXIT_NO, "on-trial",
            "%.100s: the running version is not yet found to be good: try again in "
            "some minutes",
            path);
    }
    return cli_fault_set(fault, CLI_EXIT_FAULT, "not-installed", "%.70s: not installed: %.160s",
                         path, *said ? said : "RAUC gives no reason (journalctl --unit=rauc)");
}

static enum cli_exit begin(struct cli_installer *installer, const char *path,
                           struct cli_fault *fault)
{
    sd_bus_error error = SD_BUS_ERROR_NULL;
    enum cli_exit exit = CLI_EXIT_OK;
    const int r = sd_bus_call_method(installer->bus, CLI_RAUC, CLI_RAUC_PATH, CLI_RAUC_INTERFACE,
                                     "InstallBundle", &error, NULL, "sa{sv}", path, 0);

    if (r < 0) {
        exit = cli_interrupted() ? no_end(-EINTR, fault) : cli_installer_fault(&error, r, fault);
    }
    sd_bus_error_free(&error);
    return exit;
}

static enum cli_exit finish(struct work *work, const char *path, struct cli_fault *fault)
{
    const int error = wait_for_end(work);

    if (error) {
        return no_end(error, fault);
    }
    if (work->result == 0) {
        return CLI_EXIT_OK;
    }
    const enum cli_exit exit = cli_installer_ask_state(work->installer, fault);
    return exit ? exit : refusal(work->installer, path, fault);
}

static enum cli_exit run(struct work *work, const char *path, struct cli_fault *fault)
{
    sd_bus_slot *slots[3] = {NULL, NULL, NULL};
    const int r = subscribe(work, slots);
    enum cli_exit exit = r < 0 ? cli_installer_fault(&SD_BUS_ERROR_NULL, r, fault)
                               : begin(work->installer, path, fault);

    if (!exit) {
        exit = finish(work, path, fault);
    }
    for (size_t i = 0; i < sizeof slots / sizeof *slots; i++) {
        sd_bus_slot_unref(slots[i]);
    }
    return exit;
}

static enum cli_exit busy(struct cli_fault *fault)
{
    return cli_fault_set(fault, CLI_EXIT_FAULT, "busy",
                         "another update is being installed; isotherm update shows how far it is");
}

/* Whether RAUC itself has answered with an error, and not the bus. */
static bool is_answer(const sd_bus_error *error)
{
    static const char own[] = "org.gtk.GDBus.";
    return error->name && strncmp(error->name, own, strlen(own)) == 0;
}

/* RAUC gives the same answer for each bundle that it does not accept, and for each question while
 * it is at work: another way may have begun an update since its state was asked. */
static enum cli_exit not_accepted(struct cli_installer *installer, const char *path,
                                  struct cli_fault *fault)
{
    const enum cli_exit exit = cli_installer_ask_state(installer, fault);

    if (exit) {
        return exit;
    }
    return cli_installer_is_busy(installer)
               ? busy(fault)
               : cli_fault_set(fault, CLI_EXIT_NO, "foreign-key",
                               "%.120s: no update that is signed with a key of this appliance "
                               "(journalctl --unit=rauc)",
                               path);
}

/* RAUC checks the signature of the bundle before it says for which board the bundle is. It says
 * nothing about a bundle that it does not accept, and not why. */
static enum cli_exit check_bundle(struct cli_installer *installer, const char *path,
                                  struct cli_fault *fault)
{
    const char *board = "", *version, *own = installer->state.board;
    sd_bus_error error = SD_BUS_ERROR_NULL;
    sd_bus_message *reply = NULL;
    enum cli_exit exit = CLI_EXIT_OK;
    int r = sd_bus_call_method(installer->bus, CLI_RAUC, CLI_RAUC_PATH, CLI_RAUC_INTERFACE, "Info",
                               &error, &reply, "s", path);

    if (r >= 0) {
        r = sd_bus_message_read(reply, "ss", &board, &version);
    }
    if (cli_interrupted()) {
        exit = cli_fault_set(fault, CLI_EXIT_INTERRUPTED, "interrupted", "nothing is changed");
    } else if (is_answer(&error)) {
        exit = not_accepted(installer, path, fault);
    } else if (r < 0) {
        exit = cli_installer_fault(&error, r, fault);
    } else if (strcmp(board, own) != 0) {
        exit = cli_fault_set(fault, CLI_EXIT_NO, "other-board",
                             "%.100s: it is for the board %.50s, and this is %.50s", path, board,
                             own);
    }
    sd_bus_message_unref(reply);
    sd_bus_error_free(&error);
    return exit;
}

enum cli_exit cli_installer_install(struct cli_installer *installer, const char *path,
                                    struct cli_fault *fault)
{
    struct work work = {.installer = installer};

    if (cli_installer_is_busy(installer)) {
        return busy(fault);
    }
    enum cli_exit exit = check_bundle(installer, path, fault);
    if (!exit) {
        work.progress = iso_progress_start(stderr, "isotherm", "installing the update", 100, NULL);
        exit = run(&work, path, fault);
        iso_progress_end(work.progress);
    }
    return exit;
}
