/* factory-reset: stops the services, lets the program isothermd delete what belongs to the owner of
 * the appliance, and starts the services again. */
#include "enroll/cli/commands/commands.h"

#include <string.h>
#include <unistd.h>

#include "enroll/cli/machine/child.h"
#include "enroll/cli/text/confirm.h"
#include "enroll/cli/text/report.h"

static const struct cli_confirmation confirmation = {
    .what = "factory-reset deletes everybody who is enrolled, the log, settings and accounts",
    .question =
        "This deletes the keys, everybody who is enrolled, the audit log, the settings that were\n"
        "changed, the accounts of the web server and the membership of a fleet. Nothing brings\n"
        "them back. The configuration file stays.\n",
    .not_done = "nothing was deleted",
};

/* In the order in which they are stopped, so that nothing starts one of them again meanwhile; they
 * are started in the opposite order. */
static const char *const units[] = {"isotherm-link.service", "isotherm-web.socket",
                                    "isotherm-web.service", "isothermd.service"};

enum { UNITS = sizeof units / sizeof *units };

/* Runs `systemctl WORD UNIT`. *code: its exit code. */
static enum cli_exit systemctl(const struct cli_reset_places *places, const char *option,
                               const char *word, const char *unit, int *code,
                               struct cli_fault *fault)
{
    const char *const argv[] = {places->systemctl, option, word, unit, NULL};
    struct cli_child child = {0};
    const enum cli_exit exit = cli_child_run(argv, &child, fault);

    *code = child.exit;
    cli_child_done(&child);
    return exit;
}

/* Stops the units that run, and marks them in `ran`. */
static enum cli_exit stop_all(const struct cli_reset_places *places, bool ran[UNITS],
                              struct cli_fault *fault)
{
    enum cli_exit exit = CLI_EXIT_OK;
    int code = 0;

    for (size_t i = 0; !exit && i < UNITS; i++) {
        exit = systemctl(places, "--quiet", "is-active", units[i], &code, fault);
        ran[i] = !exit && code == 0;
    }
    for (size_t i = 0; !exit && i < UNITS; i++) {
        if (!ran[i]) {
            continue;
        }
        exit = systemctl(places, "--quiet", "stop", units[i], &code, fault);
        if (!exit && code != 0) {
            exit = cli_fault_set(fault, CLI_EXIT_FAULT, "no-stop",
                                 "%s cannot be stopped; nothing was deleted", units[i]);
        }
    }
    return exit;
}

/* Starts what ran before. A unit that does not start reports that itself. */
static void start_all(const struct cli_reset_places *places, const bool ran[UNITS])
{
    struct cli_fault ignored = {0};
    int code = 0;

    for (size_t i = UNITS; i-- > 0;) {
        if (ran[i]) {
            (void)systemctl(places, "--no-block", "start", units[i], &code, &ignored);
        }
    }
}

static enum cli_exit delete_state(const struct cli_reset_places *places, struct cli_fault *fault)
{
    const char *const argv[] = {places->daemon, "--factory-reset", "--config", places->config,
                                NULL};
    struct cli_child child = {0};
    enum cli_exit exit = cli_child_run(argv, &child, fault);

    if (!exit && child.exit != 0) {
        child.err[strcspn(child.err, "\n")] = '\0';
        exit = cli_fault_set(fault, CLI_EXIT_FAULT, "reset-fault", "%s",
                             *child.err ? child.err : "isothermd --factory-reset has failed");
    }
    cli_child_done(&child);
    return exit;
}

enum cli_exit cli_factory_reset(const struct cli_reset_places *places,
                                const struct cli_arguments *arguments, struct cli_fault *fault)
{
    bool ran[UNITS] = {false};

    if (places->root && geteuid() != 0) {
        return cli_fault_set(fault, CLI_EXIT_NO, "access-denied",
                             "factory-reset deletes the state of the services: only root may (sudo "
                             "isotherm factory-reset)");
    }
    enum cli_exit exit = arguments->yes ? CLI_EXIT_OK : cli_confirm(&confirmation, fault);
    if (exit) {
        return exit;
    }
    exit = stop_all(places, ran, fault);
    if (!exit) {
        exit = delete_state(places, fault);
    }
    start_all(places, ran);
    if (exit) {
        return exit;
    }
    if (arguments->json) {
        return cli_report_json(json_pack("{s:b}", "reset", 1));
    }
    puts("The appliance is reset: it knows nobody, and its log is empty.");
    return CLI_EXIT_OK;
}
