/* update and version: the image of the appliance, its slots, updates by RAUC, and the versions of
 * all that decides how the appliance behaves. */
#include "enroll/cli/commands/commands.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "enroll/cli/client/state.h"
#include "enroll/cli/image/update_text.h"
#include "enroll/cli/image/versions.h"
#include "enroll/cli/machine/interrupt.h"
#include "enroll/cli/text/report.h"

/* Writes the absolute path of the bundle, because RAUC has another working directory. */
static enum cli_exit find_bundle(const char *name, char path[PATH_MAX], struct cli_fault *fault)
{
    struct stat status;

    if (!realpath(name, path) || stat(path, &status) < 0) {
        const enum cli_exit exit = errno == ENOENT ? CLI_EXIT_NOT_FOUND : CLI_EXIT_FAULT;
        return cli_fault_set(fault, exit, exit == CLI_EXIT_NOT_FOUND ? "no-file" : "file",
                             "%.160s: %s", name, strerror(errno));
    }
    if (!S_ISREG(status.st_mode)) {
        return cli_fault_set(fault, CLI_EXIT_FAULT, "bad-file", "%.160s: not a regular file", name);
    }
    return CLI_EXIT_OK;
}

/* Says in which slot the update is. It is installed even if RAUC does not answer this question. */
static enum cli_exit report_installed(struct cli_installer *installer, bool json)
{
    static const struct cli_slot unknown = {.name = ""};
    struct cli_fault ignored = {.text = ""};
    const struct cli_slot *slot = NULL;
    struct cli_slots slots;

    if (cli_installer_slots(installer, &slots, &ignored) == CLI_EXIT_OK) {
        slot = cli_update_waiting(&slots);
    }
    slot = slot ? slot : &unknown;
    if (json) {
        return cli_report_json(json_pack("{s:b, s:s, s:s}", "installed", 1, "slot", slot->name,
                                         "version", slot->version));
    }
    printf("The update is installed%s%s%s%s. It starts at the next restart: systemctl reboot\n",
           *slot->name ? " in slot " : "", slot->name, *slot->version ? ": version " : "",
           slot->version);
    return CLI_EXIT_OK;
}

static enum cli_exit install(struct cli_installer *installer, const char *name, bool json,
                             struct cli_fault *fault)
{
    char path[PATH_MAX];
    enum cli_exit exit = find_bundle(name, path, fault);

    if (!exit) {
        cli_interrupt_catch();
        exit = cli_installer_install(installer, path, fault);
    }
    return exit ? exit : report_installed(installer, json);
}

static enum cli_exit show(struct cli_installer *installer, const struct cli_image_places *places,
                          bool json, struct cli_fault *fault)
{
    char trial[8];
    struct cli_update_view view = {.state = cli_installer_state(installer),
                                   .busy = cli_installer_is_busy(installer),
                                   .trial = trial};

    cli_os_release_read(places->os_release, &view.running);
    cli_os_release_value(places->trial, "TRIAL", trial, sizeof trial);
    if (!view.busy) {
        const enum cli_exit exit = cli_installer_slots(installer, &view.slots, fault);
        if (exit) {
            return exit;
        }
    }
    if (json) {
        return cli_report_json(cli_update_json(&view));
    }
    cli_update_print(&view, stdout);
    return CLI_EXIT_OK;
}

enum cli_exit cli_update(const struct cli_image_places *places,
                         const struct cli_arguments *arguments, struct cli_fault *fault)
{
    struct cli_installer *installer = NULL;

    if (arguments->word && arguments->status) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "give FILE or --status, not both");
    }
    enum cli_exit exit = cli_installer_open(&arguments->bus, &installer, fault);
    if (!exit) {
        exit = arguments->word ? install(installer, arguments->word, arguments->json, fault)
                               : show(installer, places, arguments->json, fault);
    }
    cli_installer_close(installer);
    return exit;
}

/* ---- version ---- */

/* A daemon that does not answer, or not to this user, has no version. */
static void ask_daemon(const struct cli_bus *bus, struct cli_versions *versions)
{
    struct cli_fault ignored = {.text = ""};
    struct cli_daemon *daemon = NULL;
    json_t *state = NULL;

    if (cli_daemon_open(bus, &daemon, &ignored) == CLI_EXIT_OK &&
        cli_state_fetch(daemon, &state, &ignored) == CLI_EXIT_OK) {
        const char *version = cli_state_text(state, "version");
        (void)snprintf(versions->daemon, sizeof versions->daemon, "%s", version ? version : "");
    }
    json_decref(state);
    cli_daemon_close(daemon);
}

static void ask_rauc(const struct cli_bus *bus, struct cli_versions *versions)
{
    struct cli_fault ignored = {.text = ""};
    struct cli_installer *installer = NULL;
    struct cli_slots slots = {.n = 0};

    if (cli_installer_open(bus, &installer, &ignored) == CLI_EXIT_OK &&
        cli_installer_slots(installer, &slots, &ignored) == CLI_EXIT_OK) {
        for (size_t i = 0; i < slots.n; i++) {
            if (slots.slots[i].running) {
                (void)snprintf(versions->bundle, sizeof versions->bundle, "%s",
                               slots.slots[i].version);
            }
        }
    }
    cli_installer_close(installer);
}

enum cli_exit cli_version(const struct cli_image_places *places,
                          const struct cli_arguments *arguments, struct cli_fault *fault)
{
    struct cli_versions versions;

    (void)fault; /* what cannot be found out is left out */
    if (!arguments->all) {
        if (arguments->json) {
            return cli_report_json(json_pack("{s:s}", "isotherm", ISOTHERM_VERSION));
        }
        puts("isotherm " ISOTHERM_VERSION);
        return CLI_EXIT_OK;
    }
    cli_versions_read(places, &versions);
    ask_daemon(&arguments->bus, &versions);
    if (*versions.system.image) {
        ask_rauc(&arguments->bus, &versions);
    }
    if (arguments->json) {
        return cli_report_json(cli_versions_json(&versions));
    }
    cli_versions_print(&versions, stdout);
    return CLI_EXIT_OK;
}
