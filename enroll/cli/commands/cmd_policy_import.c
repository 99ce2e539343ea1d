/* policy import: read a file, show what it changes, and store it. */
#include "enroll/cli/commands/commands.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/terminal/columns.h"
#include "enroll/cli/policy/policy_reader.h"
#include "enroll/cli/policy/policy_store.h"
#include "enroll/cli/text/report.h"

/* The policy before and after the import. */
struct import {
    uint64_t revision;
    struct iso_policy_document *before, *after; /* before: NULL if there is none */
    char *document;                             /* after, as canonical text */
};

static enum cli_exit no_memory(struct cli_fault *fault)
{
    return cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "out of memory");
}

/* Reads the file. A calendar is added to the present policy. */
static enum cli_exit read_file(const struct cli_arguments *arguments, const char *present,
                               json_t **out, struct cli_fault *fault)
{
    char program[PATH_MAX];
    json_t *read = NULL;
    bool is_calendar = false;

    cli_places_policy_reader(program);
    const enum cli_exit exit = cli_policy_read_file(program, arguments->name, arguments->zone,
                                                    &read, &is_calendar, fault);
    if (exit || !is_calendar) {
        *out = read;
        return exit;
    }
    json_t *policy = present[0] ? json_loads(present, 0, NULL) : json_object();
    const bool merged = policy && cli_policy_merge(policy, read);
    json_decref(read);
    if (!merged) {
        json_decref(policy);
        return no_memory(fault);
    }
    *out = policy;
    return CLI_EXIT_OK;
}

/* Reads what the file makes of the policy, and checks it. */
static enum cli_exit read_after(const struct cli_arguments *arguments, const char *present,
                                struct import *import, struct cli_fault *fault)
{
    struct iso_fault why = {0};
    json_t *policy = NULL;
    enum cli_exit exit = read_file(arguments, present, &policy, fault);
    char *text = exit ? NULL : json_dumps(policy, JSON_COMPACT);

    json_decref(policy);
    if (!exit && !text) {
        exit = no_memory(fault);
    }
    if (!exit) {
        exit = cli_policy_read(text, &import->after, fault);
    }
    free(text);
    if (!exit && iso_policy_document_write(import->after, &import->document, &why) != 0) {
        exit = cli_fault_set(fault, CLI_EXIT_USAGE, "invalid-policy", "%s", why.text);
    }
    return exit;
}

static enum cli_exit read_both(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                               struct import *import, struct cli_fault *fault)
{
    char *present = NULL;
    enum cli_exit exit = cli_policy_fetch(daemon, &present, &import->revision, fault);

    if (!exit && present[0]) {
        exit = cli_policy_read(present, &import->before, fault);
    }
    if (!exit) {
        exit = read_after(arguments, present, import, fault);
    }
    free(present);
    return exit;
}

/* "security_level" as "security level". */
static void print_change(const json_t *change)
{
    const char *token = json_string_value(json_object_get(change, "token"));

    for (const char *c = json_string_value(json_object_get(change, "kind")); *c; c++) {
        putchar(*c == '_' ? ' ' : *c);
    }
    if (token[0]) {
        fputs(" \"", stdout);
        iso_columns_print(stdout, token, 0);
        putchar('"');
    }
    printf(": %s\n", json_string_value(json_object_get(change, "change")));
}

static enum cli_exit report(const struct import *import, json_t *changes, json_t *remarks,
                            const struct cli_arguments *arguments)
{
    size_t i;
    json_t *entry;

    if (arguments->json) {
        return cli_report_json(json_pack("{s:O, s:O, s:I, s:b}", "changes", changes, "remarks",
                                         remarks, "revision", (json_int_t)import->revision,
                                         "dry_run", arguments->dry_run));
    }
    json_array_foreach(changes, i, entry)
    {
        print_change(entry);
    }
    json_array_foreach(remarks, i, entry)
    {
        fprintf(stderr, "isotherm: %s\n", json_string_value(entry));
    }
    if (json_array_size(changes) == 0) {
        puts("The policy is the same as before.");
    } else if (arguments->dry_run) {
        puts("Nothing is stored: this was a dry run.");
    } else {
        printf("The policy is stored as revision %" PRIu64 ".\n", import->revision);
    }
    return CLI_EXIT_OK;
}

static enum cli_exit store(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                           struct import *import, struct cli_fault *fault)
{
    json_t *changes = cli_policy_changes(import->before, import->after), *remarks = NULL;
    enum cli_exit exit = changes ? CLI_EXIT_OK : no_memory(fault);

    /* An empty policy differs from none: it lets nobody in. */
    const bool differs = json_array_size(changes) > 0 || !import->before;
    if (!exit && differs && !arguments->dry_run) {
        exit = cli_policy_store(daemon, import->document, &import->revision, &remarks, fault);
    } else if (!exit) {
        remarks = json_array();
    }
    if (!exit) {
        exit = report(import, changes, remarks, arguments);
    }
    json_decref(changes);
    json_decref(remarks);
    return exit;
}

enum cli_exit cli_policy_import(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                                struct cli_fault *fault)
{
    struct import import = {.before = NULL};

    if (!arguments->name) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "a FILE is missing after 'import'");
    }
    enum cli_exit exit = read_both(daemon, arguments, &import, fault);
    if (!exit) {
        exit = store(daemon, arguments, &import, fault);
    }
    iso_policy_document_free(import.before);
    iso_policy_document_free(import.after);
    free(import.document);
    return exit;
}
