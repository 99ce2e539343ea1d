/* credential: show or change what a person has: cards, PIN, access profiles. */
#include "enroll/cli/commands/commands.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/terminal/columns.h"
#include "enroll/cli/policy/secret_digits.h"
#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

static enum cli_exit no_memory(struct cli_fault *fault)
{
    return cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "out of memory");
}

/* ---- the change, a JSON merge patch (RFC 7396) ---- */

static int put_texts(json_t *patch, const char *member, const char *const *texts, size_t n)
{
    json_t *list = json_array();
    int failed = json_object_set_new(patch, member, list);

    for (size_t i = 0; !failed && i < n; i++) {
        failed = json_array_append_new(list, json_string(texts[i]));
    }
    return failed;
}

static int put_flag(json_t *patch, const char *member, bool flag)
{
    return json_object_set_new(patch, member, json_boolean(flag));
}

/* Everything but new PINs, which must not stay in the memory of Jansson. Returns NULL without
 * memory, or for a text that is not UTF-8. */
static json_t *make_patch(const struct cli_credential_change *change)
{
    json_t *patch = json_object();
    int failed = patch ? 0 : -1;

    if (!failed && (change->n_cards > 0 || change->no_cards)) {
        failed = put_texts(patch, "cards", change->cards, change->n_cards);
    }
    if (!failed && (change->n_profiles > 0 || change->no_profiles)) {
        failed = put_texts(patch, "profiles", change->profiles, change->n_profiles);
    }
    if (!failed && change->no_pin) {
        failed = json_object_set_new(patch, "pin", json_null());
    }
    if (!failed && change->no_duress_pin) {
        failed = json_object_set_new(patch, "duress_pin", json_null());
    }
    if (!failed && (change->enable || change->disable)) {
        failed = put_flag(patch, "enabled", change->enable) ||
                 json_object_set_new(patch, "disabled_reason",
                                     json_string(change->disable ? change->disable : ""));
    }
    if (!failed && change->escort) {
        failed = put_flag(patch, "needs_escort", strcmp(change->escort, "yes") == 0);
    }
    if (!failed && change->antipassback) {
        failed = put_flag(patch, "no_antipassback", strcmp(change->antipassback, "no") == 0);
    }
    if (!failed && change->has_class) {
        failed = json_object_set_new(patch, "two_person_class",
                                     json_integer(change->two_person_class));
    }
    if (failed) {
        json_decref(patch);
        return NULL;
    }
    return patch;
}

/* The PINs that were asked for; "" for none. */
struct pins {
    char pin[CLI_PIN_SIZE], duress[CLI_PIN_SIZE];
};

static enum cli_exit ask_pins(const struct cli_credential_change *change, struct pins *pins,
                              struct cli_fault *fault)
{
    enum cli_exit exit = change->pin ? cli_pin_ask("PIN", pins->pin, fault) : CLI_EXIT_OK;

    if (!exit && change->duress_pin) {
        exit = cli_pin_ask("PIN for somebody who is forced", pins->duress, fault);
    }
    return exit;
}

/* The patch as text, with the PINs. The caller wipes and frees it. NULL: no memory. */
static char *patch_text(const json_t *patch, const struct pins *pins)
{
    char *rest = json_dumps(patch, JSON_COMPACT);
    const size_t size = (rest ? strlen(rest) : 0) + 64;
    char *text = rest ? malloc(size) : NULL;

    if (text) {
        const bool alone = strcmp(rest, "{}") == 0;
        const bool both = pins->pin[0] && pins->duress[0];
        (void)snprintf(text, size, "{%s%s%s%s%s%s%s%s%s", pins->pin[0] ? "\"pin\":\"" : "",
                       pins->pin, pins->pin[0] ? "\"" : "", both ? "," : "",
                       pins->duress[0] ? "\"duress_pin\":\"" : "", pins->duress,
                       pins->duress[0] ? "\"" : "",
                       !alone && (pins->pin[0] || pins->duress[0]) ? "," : "", rest + 1);
    }
    free(rest);
    return text;
}

static bool changes_nothing(const struct cli_credential_change *c)
{
    return c->n_cards == 0 && c->n_profiles == 0 && !c->no_cards && !c->no_profiles && !c->pin &&
           !c->duress_pin && !c->no_pin && !c->no_duress_pin && !c->enable && !c->disable &&
           !c->escort && !c->antipassback && !c->has_class;
}

static enum cli_exit check_change(const struct cli_credential_change *change,
                                  struct cli_fault *fault)
{
    const char *contradiction = change->n_cards > 0 && change->no_cards         ? "card"
                                : change->n_profiles > 0 && change->no_profiles ? "profile"
                                : change->pin && change->no_pin                 ? "pin"
                                : change->duress_pin && change->no_duress_pin   ? "duress-pin"
                                : change->enable && change->disable             ? "enable"
                                                                                : NULL;
    if (contradiction) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "give --%s or its opposite, not both",
                             contradiction);
    }
    return changes_nothing(change)
               ? cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                               "credential set takes options (see isotherm credential --help)")
               : CLI_EXIT_OK;
}

/* ---- what the daemon answers ---- */

static void print_texts(const char *label, const json_t *list, const char *none)
{
    size_t i;
    json_t *text;

    printf("%-20s ", label);
    json_array_foreach(list, i, text)
    {
        fputs(i ? ", " : "", stdout);
        iso_columns_print(stdout, json_string_value(text) ? json_string_value(text) : "?", 0);
    }
    puts(json_array_size(list) == 0 ? none : "");
}

static bool is_true(const json_t *credential, const char *member)
{
    return json_is_true(json_object_get(credential, member));
}

static void print_credential(const char *person, const json_t *credential)
{
    const char *reason = json_string_value(json_object_get(credential, "disabled_reason"));
    const json_int_t class = json_integer_value(json_object_get(credential, "two_person_class"));

    iso_columns_print(stdout, person, 20);
    fputs(is_true(credential, "enabled") ? " enabled" : " disabled", stdout);
    if (reason && reason[0]) {
        fputs(": ", stdout);
        iso_columns_print(stdout, reason, 0);
    }
    putchar('\n');
    print_texts("cards", json_object_get(credential, "cards"), "none");
    printf("%-20s %s\n", "PIN", is_true(credential, "pin") ? "yes" : "no");
    printf("%-20s %s\n", "duress PIN", is_true(credential, "duress_pin") ? "yes" : "no");
    print_texts("access profiles", json_object_get(credential, "profiles"),
                "none: the default profile counts");
    printf("%-20s %s\n", "antipassback", is_true(credential, "no_antipassback") ? "no" : "yes");
    printf("%-20s %s\n", "needs an escort", is_true(credential, "needs_escort") ? "yes" : "no");
    if (class > 0) {
        printf("%-20s %" JSON_INTEGER_FORMAT "\n", "class of pairs", class);
    }
}

static enum cli_exit report(sd_bus_message *reply, const char *method,
                            const struct cli_arguments *arguments, struct cli_fault *fault)
{
    const char *text;
    const int r = sd_bus_message_read(reply, "s", &text);
    json_t *credential = r < 0 ? NULL : json_loads(text, 0, NULL);

    if (!json_is_object(credential)) {
        json_decref(credential);
        return cli_daemon_bad_reply(r < 0 ? r : -EBADMSG, method, fault);
    }
    if (arguments->json) {
        return cli_report_json(
            json_pack("{s:s, s:o}", "person", arguments->name, "credential", credential));
    }
    print_credential(arguments->name, credential);
    json_decref(credential);
    return CLI_EXIT_OK;
}

/* Calls a method with the person and, unless it is NULL, the patch. */
static enum cli_exit call_method(struct cli_daemon *daemon, const char *method,
                                 const struct cli_arguments *arguments, const char *patch,
                                 struct cli_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    enum cli_exit exit = cli_daemon_message(daemon, method, &call, fault);

    if (exit) {
        return exit;
    }
    int r = sd_bus_message_sensitive(call); /* its memory is wiped */
    if (r >= 0) {
        r = sd_bus_message_append(call, "s", arguments->name);
    }
    if (r >= 0 && patch) {
        r = sd_bus_message_append(call, "s", patch);
    }
    if (r < 0) {
        sd_bus_message_unref(call);
        return cli_fault_set(fault, CLI_EXIT_USAGE, "invalid-name", "the name is not UTF-8");
    }
    exit = cli_daemon_send(daemon, call, &reply, fault);
    if (!exit) {
        exit = report(reply, method, arguments, fault);
    }
    sd_bus_message_unref(reply);
    return exit;
}

static enum cli_exit set(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault)
{
    struct pins pins = {.pin = ""};
    enum cli_exit exit = check_change(&arguments->credential, fault);

    if (!exit) {
        exit = ask_pins(&arguments->credential, &pins, fault);
    }
    json_t *patch = exit ? NULL : make_patch(&arguments->credential);
    char *text = patch ? patch_text(patch, &pins) : NULL;
    json_decref(patch);
    explicit_bzero(&pins, sizeof pins);
    if (!exit) {
        exit = text ? call_method(daemon, ISO_CONTRACT_SET_CREDENTIAL, arguments, text, fault)
                    : no_memory(fault);
    }
    if (text) {
        explicit_bzero(text, strlen(text));
    }
    free(text);
    return exit;
}

enum cli_exit cli_credential(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                             struct cli_fault *fault)
{
    if (strcmp(arguments->word, "set") == 0) {
        return set(daemon, arguments, fault);
    }
    if (strcmp(arguments->word, "show") == 0) {
        return changes_nothing(&arguments->credential)
                   ? call_method(daemon, ISO_CONTRACT_GET_CREDENTIAL, arguments, NULL, fault)
                   : cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                                   "credential show takes no options of credential set");
    }
    return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "credential takes show or set, not '%s'",
                         arguments->word);
}
