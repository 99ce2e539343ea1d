#include "enroll/cli/setup/install.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

#include "enroll/cli/machine/child.h"
#include "enroll/cli/machine/interrupt.h"
#include "enroll/cli/machine/new_file.h"
#include "enroll/cli/machine/service.h"

/* ---- the check ---- */

/* Copies the last message of isothermd, without the name of the program, and with the name of the
 * file instead of the name of the draft. */
static void translate(const char *said, const char *draft, const char *config, char *out,
                      size_t size)
{
    const char *line = said, *end;

    for (const char *at = said; *at; at += strcspn(at, "\n"), at += *at == '\n') {
        line = *at != '\n' ? at : line;
    }
    end = line + strcspn(line, "\n");
    if (strncmp(line, "isothermd: ", 11) == 0) {
        line += 11;
    } else if (*line == '<') {
        /* The message has a priority for the journal. */
        line += strcspn(line, ">\n") + (strchr(line, '>') != NULL);
    }
    const char *name = strstr(line, draft);
    if (name && name < end) {
        (void)snprintf(out, size, "%.*s%s%.*s", (int)(name - line), line, config,
                       (int)(end - name) - (int)strlen(draft), name + strlen(draft));
    } else {
        (void)snprintf(out, size, "%.*s", (int)(end - line), line);
    }
}

static enum cli_exit check_draft(const struct cli_setup_places *places, const char *draft,
                                 struct cli_fault *fault)
{
    const char *const argv[] = {places->daemon, "--check-config", "--config", draft, NULL};
    struct cli_child child = {0};
    char said[200];
    enum cli_exit exit = cli_child_run(argv, &child, fault);

    if (!exit && child.exit != 0) {
        translate(child.err, draft, places->config, said, sizeof said);
        exit = child.exit == CLI_EXIT_USAGE || child.exit == CLI_EXIT_NOT_FOUND
                   ? (enum cli_exit)child.exit
                   : CLI_EXIT_FAULT;
        exit = cli_fault_set(fault, exit, "bad-config", "isothermd refuses it: %s", said);
    }
    cli_child_done(&child);
    return exit;
}

enum cli_exit cli_setup_check(const struct cli_setup_places *places, const char *beside,
                              const char *text, struct cli_fault *fault)
{
    struct cli_new_file file;
    enum cli_exit exit = cli_new_file_write(beside, text, &file, fault);

    if (!exit) {
        exit = check_draft(places, file.draft, fault);
        cli_new_file_done(&file);
    }
    return exit;
}

/* ---- the start ---- */

static double now_s(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

/* Waits for the daemon's name on the bus. The unit becomes active when the daemon says so, which
 * may be before it has its name. */
static enum cli_exit wait_for_daemon(const struct cli_setup_places *places,
                                     const struct cli_bus *bus, struct cli_fault *fault)
{
    const double deadline_s = now_s() + places->daemon_wait_s;
    struct cli_daemon *daemon = NULL;
    enum cli_exit exit = cli_daemon_open(bus, &daemon, fault);
    bool running = false;

    while (!exit && !(exit = cli_daemon_has_daemon(daemon, &running, fault)) && !running) {
        if (cli_interrupted()) {
            exit = CLI_EXIT_INTERRUPTED;
        } else if (now_s() >= deadline_s) {
            exit = cli_fault_set(fault, CLI_EXIT_FAULT, "no-daemon",
                                 "%s has started, but isothermd did not come to the bus within "
                                 "%d s; journalctl --unit=%s says why",
                                 places->unit, places->daemon_wait_s, places->unit);
        } else {
            (void)nanosleep(&(struct timespec){.tv_nsec = 100 * 1000 * 1000}, NULL);
        }
    }
    cli_daemon_close(daemon);
    return exit;
}

/* ---- undoing ---- */

/* Undoes the change. Appends to the text of the fault that everything is as before, or what could
 * not be undone. */
static void undo(struct cli_service *service, struct cli_new_file *file, struct cli_fault *fault)
{
    struct cli_fault of_file = {0}, of_service = {0};
    char text[sizeof fault->text * 3];

    cli_interrupt_forget();
    const enum cli_exit replaced = cli_new_file_undo(file, &of_file);
    const enum cli_exit restored = cli_service_undo(service, &of_service);
    if (replaced) {
        (void)snprintf(text, sizeof text, "%.90s; %s", fault->text, of_file.text);
    } else {
        (void)snprintf(text, sizeof text, "%s; the configuration is as it was%s%s", fault->text,
                       restored ? ", but " : "", restored ? of_service.text : "");
    }
    (void)snprintf(fault->text, sizeof fault->text, "%.*s", (int)sizeof fault->text - 1, text);
}

static enum cli_exit start(const struct cli_setup_places *places, const struct cli_bus *daemon_bus,
                           struct cli_service *service, struct cli_new_file *file,
                           struct cli_fault *fault)
{
    enum cli_exit exit = cli_service_start(service, fault);

    if (!exit) {
        exit = wait_for_daemon(places, daemon_bus, fault);
    }
    if (exit == CLI_EXIT_INTERRUPTED) {
        (void)cli_fault_set(fault, exit, "interrupted", "interrupted");
    }
    if (exit) {
        undo(service, file, fault);
    }
    return exit;
}

/* Writes the new file next to the old one, and lets the daemon's program check it. */
static enum cli_exit write_draft(const struct cli_setup_places *places, const char *text,
                                 struct cli_new_file *file, struct cli_fault *fault)
{
    const enum cli_exit exit = cli_new_file_write(places->config, text, file, fault);

    return exit ? exit : check_draft(places, file->draft, fault);
}

enum cli_exit cli_setup_install(const struct cli_setup_places *places,
                                const struct cli_bus *daemon_bus, const char *text,
                                char backup[PATH_MAX], struct cli_fault *fault)
{
    struct cli_new_file file = {.draft = "", .backup = ""};
    struct cli_service *service = NULL;
    enum cli_exit exit = CLI_EXIT_OK;

    if (text) {
        exit = write_draft(places, text, &file, fault);
    }
    if (!exit) {
        exit = cli_service_open(&places->manager, places->unit, &service, fault);
    }
    if (!exit && text) {
        exit = cli_new_file_place(&file, fault);
    }
    if (exit && file.placed) {
        /* The file may not be on the disk yet. */
        exit = cli_new_file_undo(&file, fault) ? CLI_EXIT_FAULT : exit;
    } else if (!exit) {
        exit = start(places, daemon_bus, service, &file, fault);
    }
    cli_new_file_done(&file);
    cli_service_close(service);
    if (!exit) {
        (void)snprintf(backup, PATH_MAX, "%s", file.backup);
    }
    return exit;
}
