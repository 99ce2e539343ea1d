/* site: show what the people have taught the metric and the error rates that are estimated from
 * their templates, or take back what the metric has learned. */
#include "enroll/cli/commands/commands.h"

#include <errno.h>
#include <inttypes.h>
#include <jansson.h>
#include <string.h>

#include "enroll/cli/client/state.h"
#include "enroll/cli/text/report.h"
#include "enroll/cli/text/site_text.h"
#include "firmware/contract/contract.h"

static enum cli_exit no_memory(struct cli_fault *fault)
{
    return cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "out of memory");
}

/* ---- lists that only some users may read ---- */

static int read_pairs(sd_bus_message *reply, json_t *list)
{
    const char *person, *other;
    double score;
    int r = sd_bus_message_enter_container(reply, 'a', "(ssd)");

    while (r >= 0 && (r = sd_bus_message_read(reply, "(ssd)", &person, &other, &score)) > 0) {
        json_t *pair = json_pack("{s:s, s:s, s:f}", "person", person, "other", other, "score",
                                 score);
        if (json_array_append_new(list, pair)) {
            return -ENOMEM;
        }
    }
    return r;
}

/* Reads the names of the people who have one template. */
static int read_single(sd_bus_message *reply, json_t *list)
{
    const char *person;
    int64_t enrolled_s, from_s, until_s;
    uint32_t templates;
    int r = sd_bus_message_enter_container(reply, 'a', "(sxxxu)");

    while (r >= 0 && (r = sd_bus_message_read(reply, "(sxxxu)", &person, &enrolled_s, &from_s,
                                              &until_s, &templates)) > 0) {
        if (templates == 1 && json_array_append_new(list, json_string(person))) {
            return -ENOMEM;
        }
    }
    return r;
}

static int read_names(sd_bus_message *reply, json_t *list)
{
    const char *person;
    int r = sd_bus_message_enter_container(reply, 'a', "s");

    while (r >= 0 && (r = sd_bus_message_read(reply, "s", &person)) > 0) {
        if (json_array_append_new(list, json_string(person))) {
            return -ENOMEM;
        }
    }
    return r;
}

/* Asks for a list. *out becomes NULL if this user may not read it. */
static enum cli_exit fetch_list(struct cli_daemon *daemon, const char *method,
                                int (*read)(sd_bus_message *reply, json_t *list), json_t **out,
                                struct cli_fault *fault)
{
    sd_bus_message *reply = NULL;
    const enum cli_exit exit = cli_daemon_call(daemon, method, &reply, fault);

    *out = NULL;
    if (exit) {
        const bool denied = strcmp(fault->code, "access-denied") == 0;
        *fault = denied ? (struct cli_fault){.code = ""} : *fault;
        return denied ? CLI_EXIT_OK : exit;
    }
    json_t *list = json_array();
    const int r = list ? read(reply, list) : -ENOMEM;
    sd_bus_message_unref(reply);
    if (r < 0) {
        json_decref(list);
        return r == -ENOMEM ? no_memory(fault) : cli_daemon_bad_reply(r, method, fault);
    }
    *out = list;
    return CLI_EXIT_OK;
}

/* ---- show ---- */

static enum cli_exit fetch_site(struct cli_daemon *daemon, json_t **out, struct cli_fault *fault)
{
    sd_bus_message *reply = NULL;
    const enum cli_exit exit = cli_daemon_call(daemon, ISO_CONTRACT_GET_SITE, &reply, fault);

    if (exit) {
        return exit;
    }
    const int r = cli_state_read(reply, out);
    sd_bus_message_unref(reply);
    return r < 0 ? cli_daemon_bad_reply(r, ISO_CONTRACT_GET_SITE, fault) : CLI_EXIT_OK;
}

/* Adds the names of the people of another sensor, if there are any. */
static enum cli_exit add_others(struct cli_daemon *daemon, json_t *site, struct cli_fault *fault)
{
    json_t *names = NULL;

    if (cli_state_number(site, "site-other-sensor", 0) == 0) {
        return CLI_EXIT_OK;
    }
    const enum cli_exit exit = fetch_list(daemon, ISO_CONTRACT_LIST_OTHER, read_names, &names,
                                          fault);
    if (exit) {
        return exit;
    }
    return json_object_set_new(site, "site-other-people", names ? names : json_null())
               ? no_memory(fault)
               : CLI_EXIT_OK;
}

/* Adds the pairs who look alike, and what would help, to the reply of the daemon. */
static enum cli_exit complete(struct cli_daemon *daemon, json_t *site, struct cli_fault *fault)
{
    json_t *pairs = NULL, *single = NULL;
    enum cli_exit exit = fetch_list(daemon, ISO_CONTRACT_LIST_LOOK_ALIKES, read_pairs, &pairs,
                                    fault);

    if (exit) {
        return exit;
    }
    int error = json_object_set_new(site, "look-alike-pairs", pairs ? pairs : json_null());
    exit = fetch_list(daemon, ISO_CONTRACT_LIST_PEOPLE, read_single, &single, fault);
    if (!exit && !error) {
        error = json_object_set_new(site, "advice", cli_site_advise(site, single));
    }
    json_decref(single);
    return error ? no_memory(fault) : exit;
}

static enum cli_exit show(struct cli_daemon *daemon, bool json, struct cli_fault *fault)
{
    json_t *site = NULL;
    enum cli_exit exit = fetch_site(daemon, &site, fault);

    if (!exit) {
        exit = add_others(daemon, site, fault);
    }
    if (!exit) {
        exit = complete(daemon, site, fault);
    }
    if (!exit && json) {
        return cli_report_json(site);
    }
    if (!exit) {
        cli_site_print(site, stdout);
    }
    json_decref(site);
    return exit;
}

/* ---- reset and rollback ---- */

static enum cli_exit take_back(struct cli_daemon *daemon, const char *method, bool json,
                               struct cli_fault *fault)
{
    sd_bus_message *reply = NULL;
    uint32_t templates = 0;
    const enum cli_exit exit = cli_daemon_call(daemon, method, &reply, fault);

    if (exit) {
        return exit;
    }
    const int r = sd_bus_message_read(reply, "u", &templates);
    sd_bus_message_unref(reply);
    if (r < 0) {
        return cli_daemon_bad_reply(r, method, fault);
    }
    if (json) {
        return cli_report_json(json_pack("{s:I}", "excluded", (json_int_t)templates));
    }
    if (templates == 0) {
        puts("Nothing has changed: there is no such template that teaches the metric.");
    } else {
        printf("%u %s the metric.\n", templates,
               templates == 1 ? "template no longer teaches" : "templates no longer teach");
    }
    return CLI_EXIT_OK;
}

enum cli_exit cli_site(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                       struct cli_fault *fault)
{
    const char *word = arguments->word ? arguments->word : "show";

    if (strcmp(word, "show") == 0) {
        return show(daemon, arguments->json, fault);
    }
    if (strcmp(word, "reset") == 0) {
        return take_back(daemon, ISO_CONTRACT_RESET_SITE, arguments->json, fault);
    }
    if (strcmp(word, "rollback") == 0) {
        return take_back(daemon, ISO_CONTRACT_ROLL_BACK_SITE, arguments->json, fault);
    }
    return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                         "site takes show, reset or rollback, not '%s'", word);
}
