/* policy: show, check and remove the policy. cmd_policy_import.c and cmd_policy_test.c have the
 * other two. */
#include "enroll/cli/commands/commands.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/cli/client/state.h"
#include "enroll/cli/policy/policy_store.h"
#include "enroll/cli/policy/policy_text.h"
#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

static enum cli_exit show_text(const char *document, uint64_t revision, struct cli_fault *fault)
{
    struct iso_policy_document *policy = NULL;

    if (!document[0]) {
        puts("There is no policy: everybody who is enrolled may enter, within the limits of each "
             "person.");
        return CLI_EXIT_OK;
    }
    const enum cli_exit exit = cli_policy_read(document, &policy, fault);
    if (!exit) {
        cli_policy_print(iso_policy_document_policy(policy),
                         iso_policy_document_default_profile(policy), stdout);
        printf("Revision %" PRIu64 "\n", revision);
    }
    iso_policy_document_free(policy);
    return exit;
}

static enum cli_exit show(struct cli_daemon *daemon, bool json, struct cli_fault *fault)
{
    char *document = NULL;
    uint64_t revision = 0;
    enum cli_exit exit = cli_policy_fetch(daemon, &document, &revision, fault);

    if (exit) {
        return exit;
    }
    if (json) {
        json_t *policy = document[0] ? json_loads(document, 0, NULL) : json_null();
        exit = cli_report_json(
            json_pack("{s:o, s:I}", "policy", policy, "revision", (json_int_t)revision));
    } else {
        exit = show_text(document, revision, fault);
    }
    free(document);
    return exit;
}

static enum cli_exit check(struct cli_daemon *daemon, bool json, struct cli_fault *fault)
{
    sd_bus_message *reply = NULL;
    json_t *findings = NULL;
    const enum cli_exit exit = cli_daemon_call(daemon, ISO_CONTRACT_CHECK_POLICY, &reply, fault);

    if (exit) {
        return exit;
    }
    const int r = cli_state_read_texts(reply, &findings);
    sd_bus_message_unref(reply);
    if (r < 0) {
        return cli_daemon_bad_reply(r, ISO_CONTRACT_CHECK_POLICY, fault);
    }
    const bool clean = json_array_size(findings) == 0;
    enum cli_exit printed = CLI_EXIT_OK;
    if (json) {
        printed = cli_report_json(json_pack("{s:o}", "findings", findings));
    } else {
        for (size_t i = 0; i < json_array_size(findings); i++) {
            puts(json_string_value(json_array_get(findings, i)));
        }
        fputs(clean ? "No findings.\n" : "", stdout);
        json_decref(findings);
    }
    return printed ? printed : clean ? CLI_EXIT_OK : CLI_EXIT_NO;
}

static enum cli_exit remove_policy(struct cli_daemon *daemon, bool json, struct cli_fault *fault)
{
    char *document = NULL;
    uint64_t revision = 0;
    json_t *remarks = NULL;
    enum cli_exit exit = cli_policy_fetch(daemon, &document, &revision, fault);

    const bool was_there = !exit && document[0];
    free(document);
    if (was_there) {
        exit = cli_policy_store(daemon, "", &revision, &remarks, fault);
        json_decref(remarks);
    }
    if (exit) {
        return exit;
    }
    if (json) {
        return cli_report_json(
            json_pack("{s:b, s:I}", "removed", was_there, "revision", (json_int_t)revision));
    }
    puts(was_there ? "The policy is removed: everybody who is enrolled may enter, within the "
                     "limits of each person."
                   : "There is no policy.");
    return CLI_EXIT_OK;
}

enum cli_exit cli_policy(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault)
{
    const char *word = arguments->word;
    const bool imports = strcmp(word, "import") == 0, tests = strcmp(word, "test") == 0;

    if (!imports && arguments->name) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "policy %s takes no file, but '%s'",
                             word, arguments->name);
    }
    if (!imports && (arguments->dry_run || arguments->zone)) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "policy %s takes no --%s", word,
                             arguments->dry_run ? "dry-run" : "zone");
    }
    if (!tests &&
        (arguments->has_at || arguments->door || arguments->shown || arguments->n_people > 0)) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "--person, --at, --door and --shown belong to policy test");
    }
    if (imports) {
        return cli_policy_import(daemon, arguments, fault);
    }
    if (tests) {
        return cli_policy_test(daemon, arguments, fault);
    }
    if (strcmp(word, "show") == 0) {
        return show(daemon, arguments->json, fault);
    }
    if (strcmp(word, "check") == 0) {
        return check(daemon, arguments->json, fault);
    }
    if (strcmp(word, "remove") == 0) {
        return remove_policy(daemon, arguments->json, fault);
    }
    return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                         "policy takes import, show, test, check or remove, not '%s'", word);
}
