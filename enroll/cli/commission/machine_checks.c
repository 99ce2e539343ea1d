#include "enroll/cli/commission/machine_checks.h"

#include <inttypes.h>
#include <string.h>

#include "enroll/cli/client/long_call.h"
#include "enroll/cli/client/state.h"
#include "enroll/cli/doctor/examine.h"
#include "enroll/cli/machine/interrupt.h"
#include "firmware/contract/contract.h"

/* Frames are counted for two seconds, in which an interrupt is noticed ten times. */
static const double slice_s = 0.2;
enum { SLICES = 10 };

/* What the checks share. */
struct checks {
    struct cli_daemon *daemon;
    struct cli_diagnosis diagnosis;
    json_t *state; /* the status of the daemon when the checks began */
};

/* ---- by the findings of the doctor ---- */

static const char *answer_of(enum cli_check check)
{
    switch (check) {
    case CLI_CHECK_GOOD:
        return ISO_CONTRACT_ANSWER_OK;
    case CLI_CHECK_ODD:
        return ISO_CONTRACT_ANSWER_WARNING;
    default:
        return ISO_CONTRACT_ANSWER_FAULT;
    }
}

static bool has_item(const char *subject)
{
    for (size_t i = 0; i < CLI_CHECKLIST_ITEMS; i++) {
        if (cli_checklist[i].subject && strcmp(cli_checklist[i].subject, subject) == 0) {
            return true;
        }
    }
    return false;
}

/* Stores the worst finding of a subject; NULL: of all subjects that have no item. The doctor
 * reports several subjects only if something is wrong with them. */
static void check_findings(const struct cli_diagnosis *diagnosis, const char *subject,
                           struct cli_result_of_check *result)
{
    const struct cli_finding *worst = NULL;

    for (size_t i = 0; i < diagnosis->n_findings; i++) {
        const struct cli_finding *finding = &diagnosis->findings[i];
        const bool belongs = subject ? strcmp(finding->subject, subject) == 0
                                     : !has_item(finding->subject);
        if (belongs && (!worst || finding->check > worst->check)) {
            worst = finding;
        }
    }
    if (!worst) {
        cli_results_set(result, ISO_CONTRACT_ANSWER_OK, "");
    } else if (subject) {
        cli_results_set(result, answer_of(worst->check), worst->found);
    } else {
        char remark[sizeof worst->found + 32];
        (void)snprintf(remark, sizeof remark, "%s: %s", worst->subject, worst->found);
        cli_results_set(result, answer_of(worst->check),
                        worst->check == CLI_CHECK_GOOD ? "" : remark);
    }
}

/* ---- by other means ---- */

/* Waits for two seconds. */
static enum cli_exit wait_for_frames(struct cli_daemon *daemon, struct cli_fault *fault)
{
    for (int i = 0; i < SLICES; i++) {
        const enum cli_exit exit = cli_daemon_wait(daemon, slice_s, fault);
        if (exit != CLI_EXIT_TIMED_OUT) {
            return exit;
        }
        if (cli_interrupted()) {
            return CLI_EXIT_INTERRUPTED;
        }
    }
    return CLI_EXIT_OK;
}

/* Counts the frames by the clock of the daemon. */
static enum cli_exit check_frames(const struct checks *checks, struct cli_result_of_check *result,
                                  struct cli_fault *fault)
{
    json_t *begin = NULL, *end = NULL;
    char remark[64];
    enum cli_exit exit = cli_state_fetch(checks->daemon, &begin, fault);

    if (!exit) {
        exit = wait_for_frames(checks->daemon, fault);
    }
    if (!exit) {
        exit = cli_state_fetch(checks->daemon, &end, fault);
    }
    if (!exit) {
        const json_int_t n = cli_state_number(end, "frames", 0) -
                             cli_state_number(begin, "frames", 0);
        const json_int_t ms = cli_state_number(end, "uptime-ms", 0) -
                              cli_state_number(begin, "uptime-ms", 0);
        const double rate = ms > 0 ? 1000.0 * (double)n / (double)ms : 0.0;
        (void)snprintf(remark, sizeof remark, "%.1f frames a second", rate);
        cli_results_set(result,
                        rate >= CLI_CHECKLIST_FRAMES_PER_S ? ISO_CONTRACT_ANSWER_OK
                                                           : ISO_CONTRACT_ANSWER_FAULT,
                        remark);
    }
    json_decref(begin);
    json_decref(end);
    return exit;
}

/* A key that is a file protects against nobody who takes the disk with it. */
static void check_key(const json_t *state, struct cli_result_of_check *result)
{
    const char *place = cli_state_text(state, "key-place");

    if (place && strcmp(place, "credential") == 0) {
        cli_results_set(result, ISO_CONTRACT_ANSWER_OK, place);
    } else {
        cli_results_set(result, ISO_CONTRACT_ANSWER_WARNING,
                        place ? "a file: see KEYS in isothermd(8)" : "not reported");
    }
}

static enum cli_exit check_log(const struct checks *checks, struct cli_result_of_check *result,
                               struct cli_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    uint64_t first = 0, last = 0, flaw_at = 0;
    const char *head = NULL, *flaw = NULL;
    char remark[128];
    int sound = 0;
    enum cli_exit exit = cli_daemon_message(checks->daemon, ISO_CONTRACT_VERIFY_LOG, &call, fault);

    if (exit) {
        return exit;
    }
    int r = sd_bus_message_append(call, "ts", (uint64_t)0, "");
    if (r < 0) {
        sd_bus_message_unref(call);
        return cli_daemon_bad_reply(r, ISO_CONTRACT_VERIFY_LOG, fault);
    }
    exit = cli_long_call(checks->daemon, call, "verifying the log", &reply, fault);
    if (exit) {
        return exit;
    }
    r = sd_bus_message_read(reply, "bttsts", &sound, &first, &last, &head, &flaw_at, &flaw);
    if (r < 0) {
        exit = cli_daemon_bad_reply(r, ISO_CONTRACT_VERIFY_LOG, fault);
    } else if (sound) {
        (void)snprintf(remark, sizeof remark, "records %" PRIu64 " to %" PRIu64, first, last);
        cli_results_set(result, ISO_CONTRACT_ANSWER_OK, remark);
    } else {
        cli_results_set(result, ISO_CONTRACT_ANSWER_FAULT, flaw);
    }
    sd_bus_message_unref(reply);
    return exit;
}

void cli_machine_check_relay(struct cli_daemon *daemon, struct cli_result_of_check *result)
{
    struct cli_fault fault = {0};

    if (cli_daemon_call(daemon, ISO_CONTRACT_TEST_DOOR, NULL, &fault)) {
        cli_results_set(result, ISO_CONTRACT_ANSWER_FAULT, fault.text);
    } else {
        cli_results_set(result, ISO_CONTRACT_ANSWER_OK, "switched for half a second");
    }
}

/* ---- all of them ---- */

static enum cli_exit check_item(const struct checks *checks, const struct cli_checklist_item *item,
                                struct cli_result_of_check *result, struct cli_fault *fault)
{
    switch (item->way) {
    case CLI_WAY_FRAMES:
        return check_frames(checks, result, fault);
    case CLI_WAY_LOG:
        return check_log(checks, result, fault);
    case CLI_WAY_KEY:
        check_key(checks->state, result);
        return CLI_EXIT_OK;
    default:
        check_findings(&checks->diagnosis, item->subject, result);
        return CLI_EXIT_OK;
    }
}

enum cli_exit cli_machine_checks(const struct cli_bus *bus, struct cli_daemon *daemon, FILE *out,
                                 struct cli_check_results *results, struct cli_fault *fault)
{
    struct checks checks = {.daemon = daemon};
    enum cli_exit exit = cli_state_fetch(daemon, &checks.state, fault);

    if (!exit) {
        cli_doctor_examine(bus, &checks.diagnosis);
    }
    for (size_t i = 0; !exit && i < CLI_CHECKLIST_ITEMS; i++) {
        if (cli_checklist_asks(&cli_checklist[i])) {
            continue;
        }
        exit = check_item(&checks, &cli_checklist[i], &results->items[i], fault);
        if (!exit) {
            cli_results_print(&cli_checklist[i], &results->items[i], out);
        }
    }
    json_decref(checks.state);
    return exit;
}
