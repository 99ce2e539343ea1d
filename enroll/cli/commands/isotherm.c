/* isotherm: the command line client of the appliance. */
#include <stdio.h>

#include "drivers/terminal/output.h"
#include "enroll/cli/arguments/arguments.h"
#include "enroll/cli/commands/commands.h"
#include "enroll/cli/doctor/configured.h"
#include "enroll/cli/text/report.h"

/* The commands that need no connection to the daemon, or make their own. False: it is another. */
static bool run_alone(const struct cli_arguments *arguments, enum cli_exit *exit,
                      struct cli_fault *fault)
{
    switch (arguments->verb) {
    case CLI_DOCTOR:
        *exit = cli_doctor(arguments, fault);
        return true;
    case CLI_SETUP:
        *exit = cli_setup(arguments, fault);
        return true;
    case CLI_WEB:
        *exit = cli_web(&cli_web_installed, arguments, fault);
        return true;
    case CLI_VERSION:
        *exit = cli_version(&cli_image_installed, arguments, fault);
        return true;
    case CLI_UPDATE:
        *exit = cli_update(&cli_image_installed, arguments, fault);
        return true;
    case CLI_FACTORY_RESET:
        *exit = cli_factory_reset(&cli_reset_installed, arguments, fault);
        return true;
    default:
        return false;
    }
}

static enum cli_exit run(const struct cli_arguments *arguments, struct cli_fault *fault)
{
    static enum cli_exit (*const commands[CLI_VERBS])(
        struct cli_daemon *, const struct cli_arguments *, struct cli_fault *) = {
        [CLI_ENROLL] = cli_enroll,
        [CLI_IDENTIFY] = cli_identify,
        [CLI_VERIFY] = cli_verify,
        [CLI_LIST] = cli_list,
        [CLI_REMOVE] = cli_remove,
        [CLI_STATUS] = cli_status,
        [CLI_LOG] = cli_log,
        [CLI_AIM] = cli_aim,
        [CLI_EXPORT] = cli_export,
        [CLI_IMPORT] = cli_import,
        [CLI_KEY] = cli_key,
        [CLI_LOCKDOWN] = cli_lockdown,
        [CLI_LOCKOUT] = cli_lockout,
        [CLI_VALIDITY] = cli_validity,
        [CLI_RENAME] = cli_rename,
        [CLI_DOOR] = cli_door_test,
        [CLI_SITE] = cli_site,
        [CLI_POLICY] = cli_policy,
        [CLI_CREDENTIAL] = cli_credential,
        [CLI_PANEL] = cli_panel,
        [CLI_SETTINGS] = cli_settings,
    };
    struct cli_daemon *daemon = NULL;
    enum cli_exit exit = cli_daemon_open(&arguments->bus, &daemon, fault);
    if (exit == CLI_EXIT_OK) {
        exit = commands[arguments->verb](daemon, arguments, fault);
    }
    cli_daemon_close(daemon);
    return exit;
}

int main(int argc, char **argv)
{
    struct cli_arguments arguments;
    struct cli_fault fault = {0};
    enum cli_exit exit = cli_arguments_parse(argc, argv, &arguments, &fault);

    if (exit == CLI_EXIT_OK && arguments.version) {
        puts("isotherm " ISOTHERM_VERSION);
    } else if (exit == CLI_EXIT_OK && arguments.help) {
        cli_arguments_help(arguments.verb, stdout);
    } else if (exit == CLI_EXIT_OK) {
        /* Writes line by line, because people read hints and new records as they come. */
        setvbuf(stdout, NULL, _IOLBF, 0);
        if (!run_alone(&arguments, &exit, &fault)) {
            exit = run(&arguments, &fault);
        }
        cli_explain_no_daemon(&arguments.bus, exit, &fault);
    }
    if (fault.text[0]) {
        cli_report_fault(&fault, exit, arguments.json);
    }
    return iso_output_end("isotherm") && exit == CLI_EXIT_OK ? CLI_EXIT_FAULT : (int)exit;
}
