/* web: what the first person needs who opens the pages of the web server. The program isotherm-web
 * answers; so this program needs no library for TLS. */
#include "enroll/cli/commands/commands.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "enroll/cli/machine/child.h"
#include "enroll/cli/machine/web_address.h"
#include "enroll/cli/text/report.h"

/* Cuts the text at the end of its first line. */
static char *first_line(char *text)
{
    text[strcspn(text, "\n")] = '\0';
    return text;
}

/* What the program says when it fails, without its own name in front. */
static const char *complaint(char *err, const char *otherwise)
{
    static const char own[] = "isotherm-web: ";
    const char *line = first_line(err);

    line += strncmp(line, own, strlen(own)) == 0 ? strlen(own) : 0;
    return *line ? line : otherwise;
}

/* Runs `isotherm-web WORD` and returns the one line that it prints, which the caller frees. */
static enum cli_exit ask(const struct cli_web_places *places, const char *word, char **line,
                         struct cli_fault *fault)
{
    const char *const argv[] = {places->program, word, NULL};
    struct cli_child child = {0};

    enum cli_exit exit = cli_child_run(argv, &child, fault);
    if (exit) {
        return exit;
    }
    if (child.exit != 0 || !*first_line(child.out)) {
        exit = cli_fault_set(fault, CLI_EXIT_FAULT, "web-fault", "isotherm-web %s: %s", word,
                             complaint(child.err, "it gives no answer"));
    } else {
        *line = child.out;
        child.out = NULL;
    }
    cli_child_done(&child);
    return exit;
}

static enum cli_exit check_program(const struct cli_web_places *places, struct cli_fault *fault)
{
    if (access(places->program, X_OK) < 0) {
        return errno == ENOENT
                   ? cli_fault_set(fault, CLI_EXIT_NOT_FOUND, "no-program",
                                   "the web server is not installed: there is no %.150s (package "
                                   "isotherm-web)",
                                   places->program)
                   : cli_fault_set(fault, CLI_EXIT_FAULT, "no-program", "%.150s cannot be run: %s",
                                   places->program, strerror(errno));
    }
    return CLI_EXIT_OK;
}

static enum cli_exit check_root(const struct cli_web_places *places, const char *word,
                                struct cli_fault *fault)
{
    if (places->root && geteuid() != 0) {
        return cli_fault_set(fault, CLI_EXIT_NO, "access-denied",
                             "web %s reads the state of the web server: only root may (sudo "
                             "isotherm web %s)",
                             word, word);
    }
    return CLI_EXIT_OK;
}

static json_t *urls_of(const struct cli_web_addresses *addresses)
{
    json_t *urls = json_array();

    for (size_t i = 0; i < addresses->n; i++) {
        (void)json_array_append_new(urls, json_string(addresses->urls[i]));
    }
    return urls;
}

static enum cli_exit print_setup(const char *code, const char *fingerprint,
                                 const struct cli_web_addresses *addresses, bool json)
{
    if (json) {
        return cli_report_json(json_pack("{s:s, s:o, s:s}", "code", code, "addresses",
                                         urls_of(addresses), "fingerprint", fingerprint));
    }
    printf("Open one of these addresses in a browser:\n");
    for (size_t i = 0; i < addresses->n; i++) {
        printf("  %s\n", addresses->urls[i]);
    }
    printf("The browser does not know the certificate and warns. Go on only if it shows this "
           "SHA-256 fingerprint:\n  %s\n"
           "Make your account with this code, which is valid once and for a day:\n  %s\n",
           fingerprint, code);
    return CLI_EXIT_OK;
}

/* The fingerprint comes first: without a certificate there is no server that could take the code.
 */
static enum cli_exit set_up(const struct cli_web_places *places, bool json, struct cli_fault *fault)
{
    struct cli_web_addresses addresses;
    char *fingerprint = NULL, *code = NULL;

    enum cli_exit exit = ask(places, "fingerprint", &fingerprint, fault);
    if (!exit) {
        exit = ask(places, "setup-code", &code, fault);
    }
    if (!exit) {
        cli_web_addresses_find(places->systemctl, &addresses);
        exit = print_setup(code, fingerprint, &addresses, json);
    }
    free(code);
    free(fingerprint);
    return exit;
}

static enum cli_exit show_fingerprint(const struct cli_web_places *places, bool json,
                                      struct cli_fault *fault)
{
    char *fingerprint = NULL;

    enum cli_exit exit = ask(places, "fingerprint", &fingerprint, fault);
    if (!exit && json) {
        exit = cli_report_json(json_pack("{s:s}", "fingerprint", fingerprint));
    } else if (!exit) {
        puts(fingerprint);
    }
    free(fingerprint);
    return exit;
}

static enum cli_exit show_addresses(const struct cli_web_places *places, bool json)
{
    struct cli_web_addresses addresses;

    cli_web_addresses_find(places->systemctl, &addresses);
    if (json) {
        return cli_report_json(json_pack("{s:o}", "addresses", urls_of(&addresses)));
    }
    for (size_t i = 0; i < addresses.n; i++) {
        puts(addresses.urls[i]);
    }
    return CLI_EXIT_OK;
}

enum cli_exit cli_web(const struct cli_web_places *places, const struct cli_arguments *arguments,
                      struct cli_fault *fault)
{
    const char *word = arguments->word;
    const bool sets_up = strcmp(word, "setup") == 0, addresses = strcmp(word, "address") == 0;

    if (!sets_up && !addresses && strcmp(word, "fingerprint") != 0) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "web takes 'setup', 'address' or 'fingerprint', not '%s'", word);
    }
    enum cli_exit exit = check_program(places, fault);
    if (!exit && addresses) {
        return show_addresses(places, arguments->json);
    }
    exit = exit ? exit : check_root(places, word, fault);
    if (exit) {
        return exit;
    }
    return sets_up ? set_up(places, arguments->json, fault)
                   : show_fingerprint(places, arguments->json, fault);
}
