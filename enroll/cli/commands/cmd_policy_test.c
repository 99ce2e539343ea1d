/* policy test: would somebody be let in? */
#include "enroll/cli/commands/commands.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "drivers/terminal/columns.h"
#include "enroll/cli/arguments/when_next.h"
#include "enroll/cli/client/state.h"
#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

/* Appends the methods of "face,card". Returns 0, a negative errno of sd-bus, or 1 for a word that
 * is no method. */
static int append_methods(sd_bus_message *call, const char *shown)
{
    int r = sd_bus_message_open_container(call, 'a', "s");

    for (const char *word = shown; r >= 0 && *word;) {
        const size_t size = strcspn(word, ",");
        char text[8] = "";
        if (size < sizeof text) {
            memcpy(text, word, size);
        }
        if (strcmp(text, "face") != 0 && strcmp(text, "card") != 0 && strcmp(text, "pin") != 0) {
            return 1;
        }
        r = sd_bus_message_append(call, "s", text);
        word += size + (word[size] == ',');
    }
    return r < 0 ? r : sd_bus_message_close_container(call);
}

static enum cli_exit make_call(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                               int64_t at_s, sd_bus_message **out, struct cli_fault *fault)
{
    sd_bus_message *call = NULL;
    const enum cli_exit exit = cli_daemon_message(daemon, ISO_CONTRACT_TEST_ACCESS, &call, fault);

    if (exit) {
        return exit;
    }
    int r = sd_bus_message_append(call, "ssx", arguments->people[0],
                                  arguments->door ? arguments->door : "", at_s);
    if (r >= 0) {
        r = append_methods(call, arguments->shown ? arguments->shown : "face");
    }
    if (r == 0 || (r > 0 && !arguments->shown)) {
        *out = call;
        return CLI_EXIT_OK;
    }
    sd_bus_message_unref(call);
    return r > 0 ? cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                                 "--shown: '%s' is not a list of face, card and pin",
                                 arguments->shown)
                 : cli_fault_set(fault, CLI_EXIT_USAGE, "invalid-name", "the name is not UTF-8");
}

/* Why somebody is refused, in plain words; the word of ONVIF for another reason. */
static const char *explain(const char *reason)
{
    static const struct {
        const char *reason, *text;
    } texts[] = {
        {"CredentialNotFound", "there is no such person"},
        {"CredentialNotEnabled", "the credential is disabled"},
        {"CredentialNotActive", "the credential is not valid yet"},
        {"CredentialExpired", "the credential is no longer valid"},
        {"Unauthorized",
         "no access profile of this person names the access point, or the person has nothing with "
         "which to pass it"},
        {"NotPermittedAtThisTime", "not at this time"},
        {"pt:InvalidIdentifierValue", "what was shown belongs to somebody else"},
        {"InvalidPIN", "the PIN is wrong"},
        {"isotherm:AntipassbackViolation", "the person is somewhere else, as far as is known"},
        {"isotherm:NoPair", "these two may not enter together"},
        {"isotherm:NoLease", "the hub has not answered for too long"},
        {"isotherm:NotApproved", "the hub has not approved this person yet"},
        {"Other", "the access point is out of service, or there is none of this name"},
    };

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        if (strcmp(texts[i].reason, reason) == 0) {
            return texts[i].text;
        }
    }
    return reason;
}

static void print_wanted(const json_t *answer)
{
    const json_t *wanted = json_object_get(answer, "wanted");
    const size_t n = json_array_size(wanted);

    for (size_t i = 0; i < n; i++) {
        const char *word = json_string_value(json_array_get(wanted, i));
        printf("%s%s",
               i == 0      ? " "
               : i + 1 < n ? ", "
                           : " and ",
               word && strcmp(word, "pin") == 0 ? "PIN"
               : word                           ? word
                                                : "?");
    }
    if (json_is_true(json_object_get(answer, "companion"))) {
        fputs(n > 0 ? " and a second person" : " a second person", stdout);
    }
}

/* One sentence: "ada would be let in at front on Sunday 2026-11-29 at 09:00." */
static void print_answer(const json_t *answer, const char *person, int64_t at_s)
{
    const char *outcome = cli_state_text(answer, "outcome");
    const char *point = cli_state_text(answer, "access-point");
    const char *reason = cli_state_text(answer, "reason");
    char when[CLI_WHEN_DAY_SIZE];

    cli_when_format_day(at_s, when);
    iso_columns_print(stdout, person, 0);
    fputs(strcmp(outcome, "allow") == 0  ? " would be let in"
          : strcmp(outcome, "want") == 0 ? " would be asked for more"
                                         : " would not be let in",
          stdout);
    fputs(point && point[0] ? " at " : " at this door", stdout);
    iso_columns_print(stdout, point ? point : "", 0);
    printf(" on %s", when);
    if (strcmp(outcome, "want") == 0) {
        putchar(':');
        print_wanted(answer);
    } else if (strcmp(outcome, "deny") == 0) {
        printf(": %s", explain(reason ? reason : ""));
    }
    puts(".");
}

static enum cli_exit exit_of(const char *outcome)
{
    return strcmp(outcome, "allow") == 0  ? CLI_EXIT_OK
           : strcmp(outcome, "want") == 0 ? CLI_EXIT_MORE
                                          : CLI_EXIT_NO;
}

enum cli_exit cli_policy_test(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                              struct cli_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    json_t *answer = NULL;
    const int64_t at_s = arguments->has_at ? arguments->at_s : (int64_t)time(NULL);

    if (arguments->n_people != 1) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "policy test needs one --person");
    }
    enum cli_exit exit = make_call(daemon, arguments, at_s, &call, fault);
    if (!exit) {
        exit = cli_daemon_send(daemon, call, &reply, fault);
    }
    if (exit) {
        return exit;
    }
    const int r = cli_state_read(reply, &answer);
    sd_bus_message_unref(reply);
    const char *outcome = r < 0 ? NULL : cli_state_text(answer, "outcome");
    if (!outcome) {
        json_decref(answer);
        return cli_daemon_bad_reply(r < 0 ? r : -EBADMSG, ISO_CONTRACT_TEST_ACCESS, fault);
    }
    const enum cli_exit result = exit_of(outcome);
    if (arguments->json) {
        exit = json_object_set_new(answer, "person", json_string(arguments->people[0])) == 0 &&
                       json_object_set_new(answer, "time", json_integer(at_s)) == 0
                   ? cli_report_json(answer)
                   : cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "out of memory");
    } else {
        print_answer(answer, arguments->people[0], at_s);
        json_decref(answer);
    }
    return exit ? exit : result;
}
