#include "enroll/cli/arguments/arguments.h"

#include <getopt.h>
#include <string.h>

#include "drivers/terminal/words.h"
#include "enroll/cli/arguments/command_table.h"
#include "enroll/cli/arguments/log_event.h"
#include "enroll/cli/arguments/option_table.h"
#include "enroll/cli/arguments/option_value.h"

/* What getopt returns for option 0. It is above every character, because getopt returns characters,
 * too. */
enum { FIRST_OPTION = 256 };

_Static_assert(CLI_OPTIONS <= 64, "the options given are the bits of a uint64_t");

/* Finds "--json" anywhere, even after a fault that ends the parsing. */
static bool wants_json(int argc, char **argv)
{
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
        if (strcmp(argv[i], "--json") == 0) {
            return true;
        }
    }
    return false;
}

static void make_getopt_table(struct option table[CLI_OPTIONS + 1])
{
    for (size_t i = 0; i < CLI_OPTIONS; i++) {
        table[i] = (struct option){cli_options[i].name, cli_options[i].argument != NULL, NULL,
                                   FIRST_OPTION + (int)i};
    }
    table[CLI_OPTIONS] = (struct option){0};
}

static enum cli_exit usage_fault(struct cli_fault *fault, const char *text, const char *word)
{
    return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "%s '%s' (see isotherm --help)", text,
                         word);
}

/* Converts the result of getopt_long, for a long name or a single letter, to the option. */
static enum cli_option_id option_found(int found)
{
    switch (found) {
    case 'n':
        return CLI_OPTION_COUNT;
    case 'h':
        return CLI_OPTION_HELP;
    default:
        return (enum cli_option_id)(found - FIRST_OPTION);
    }
}

static const char *next_option(size_t index, const void *context)
{
    (void)context;
    return index < CLI_OPTIONS ? cli_options[index].name : NULL;
}

static const char *next_verb(size_t index, const void *context)
{
    (void)context;
    return index < CLI_VERBS ? cli_commands[index].name : NULL;
}

static enum cli_exit unknown_option(struct cli_fault *fault, const char *word)
{
    char typed[64];
    const bool is_long = strncmp(word, "--", 2) == 0 && !strchr(word, '=');

    (void)snprintf(typed, sizeof typed, "%s", is_long ? word + 2 : "");
    const char *meant = iso_words_nearest(typed, next_option, NULL);
    if (meant) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "unknown option '%s': did you mean '--%s'?", word, meant);
    }
    return usage_fault(fault, "unknown option, or one that takes no value:", word);
}

static enum cli_exit unknown_command(struct cli_fault *fault, const char *word)
{
    const char *meant = iso_words_nearest(word, next_verb, NULL);

    return meant ? cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                                 "unknown command '%s': did you mean '%s'?", word, meant)
                 : usage_fault(fault, "unknown command", word);
}

/* An example of a good value, by the name of the argument. It is printed after the fault of a bad
 * value; "" if there is none. */
static const char *example_of(const char *argument)
{
    if (strcmp(argument, "T") == 0) {
        return "; a time looks like 2026-12-31, 2026-12-31T18:00 or 2026-12-31T18:00Z (UTC)";
    }
    return strcmp(argument, "D") == 0 ? "; a day looks like 2026-12-31, today or yesterday" : "";
}

/* Reads the options, and marks in *given which ones are on the command line, with one bit for each
 * option of the table. */
static enum cli_exit parse_options(int argc, char **argv, struct cli_arguments *out,
                                   uint64_t *given, struct cli_fault *fault)
{
    struct option table[CLI_OPTIONS + 1];
    int found;

    make_getopt_table(table);
    opterr = 0;
    optind = 0; /* GNU: starts again, also after an earlier call */
    while ((found = getopt_long(argc, argv, ":hn:", table, NULL)) != -1) {
        if (found == '?') {
            return unknown_option(fault, argv[optind - 1]);
        }
        if (found == ':') {
            return usage_fault(fault, "a value is missing after", argv[optind - 1]);
        }
        const enum cli_option_id id = option_found(found);
        if (!cli_option_store(out, id, optarg)) {
            return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "--%s: bad value '%s'%s",
                                 cli_options[id].name, optarg,
                                 example_of(cli_options[id].argument));
        }
        *given |= UINT64_C(1) << id;
    }
    return CLI_EXIT_OK;
}

/* Reports that a word is missing after `after`. A command with fixed words, such as "on|off", lists
 * them as text: "on or off". */
static enum cli_exit missing_word(const struct cli_command *command, const char *after,
                                  struct cli_fault *fault)
{
    const char *takes = command->words, *bar = strchr(takes, '|');

    if (strpbrk(takes, "ABCDEFGHIJKLMNOPQRSTUVWXYZ")) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "a %s is missing after '%s' (see isotherm --help)",
                             strchr(takes, ' ') ? "word" : takes, after);
    }
    return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "'%s' needs a word: %.*s%s%s",
                         command->name, (int)strcspn(takes, "|"), takes, bar ? " or " : "",
                         bar ? bar + 1 : "");
}

static enum cli_exit parse_words(int n_words, char **words, struct cli_arguments *out,
                                 struct cli_fault *fault)
{
    if (n_words == 0) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "no command given (see isotherm --help)");
    }
    for (out->verb = 0; out->verb < CLI_VERBS; out->verb++) {
        if (strcmp(words[0], cli_commands[out->verb].name) == 0) {
            break;
        }
    }
    if (out->verb == CLI_VERBS) {
        return unknown_command(fault, words[0]);
    }
    const char *takes = cli_commands[out->verb].words;
    const int most = 1 + (*takes != '\0') + (strchr(takes, ' ') != NULL);
    /* The last word may be missing, or, if the first one may be missing, all. */
    const int least = *takes == '[' ? 1 : most - (strchr(takes, '[') != NULL);
    if (n_words < least && !out->help) {
        return missing_word(&cli_commands[out->verb], words[n_words - 1], fault);
    }
    if (n_words > most) {
        return usage_fault(fault, "superfluous word", words[most]);
    }
    out->word = n_words > 1 ? words[1] : NULL;
    out->person = out->word;
    out->name = n_words > 2 ? words[2] : NULL;
    return CLI_EXIT_OK;
}

static enum cli_exit read_from(struct cli_arguments *out, struct cli_fault *fault)
{
    if (cli_option_read_from(out)) {
        return CLI_EXIT_OK;
    }
    return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "--from: bad value '%s'%s", out->from_text,
                         example_of(out->verb == CLI_LOG ? "N" : "T"));
}

/* Checks that the limits on the command line can be combined. --none sets both. */
static enum cli_exit check_limits(struct cli_arguments *arguments, struct cli_fault *fault)
{
    const bool enrols = arguments->verb == CLI_ENROLL;

    if (arguments->none && (arguments->names_from || arguments->names_until)) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "give --none, or --from and --until, not both");
    }
    if (arguments->none) {
        arguments->names_from = arguments->names_until = true;
    }
    if (arguments->verb == CLI_VALIDITY && !arguments->names_from && !arguments->names_until &&
        !arguments->help) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "validity takes --from, --until or --none (see isotherm --help)");
    }
    if (arguments->valid_from_s && arguments->valid_until_s &&
        arguments->valid_from_s >= arguments->valid_until_s) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "--%suntil is not after --%sfrom",
                             enrols ? "valid-" : "", enrols ? "valid-" : "");
    }
    return CLI_EXIT_OK;
}

static enum cli_exit check_options(const struct cli_arguments *arguments, uint64_t given,
                                   struct cli_fault *fault)
{
    for (size_t i = 0; i < CLI_OPTIONS; i++) {
        const unsigned verbs = cli_options[i].verbs;
        if ((given & UINT64_C(1) << i) && verbs && !(verbs & CLI_FOR(arguments->verb))) {
            return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "%s takes no --%s",
                                 cli_commands[arguments->verb].name, cli_options[i].name);
        }
    }
    if (arguments->answers && !arguments->commission) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "--answers needs --commission");
    }
    if (arguments->csv && arguments->json) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "give --csv or --json, not both");
    }
    if (arguments->bus.address && arguments->bus.session) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "give --bus or --session, not both");
    }
    return cli_log_events_check(arguments->events, fault);
}

enum cli_exit cli_arguments_parse(int argc, char **argv, struct cli_arguments *out,
                                  struct cli_fault *fault)
{
    uint64_t given = 0;
    enum cli_exit exit;

    *out = (struct cli_arguments){.verb = CLI_VERBS, .json = wants_json(argc, argv)};
    exit = parse_options(argc, argv, out, &given, fault);
    int n_words = argc - optind;
    char **words = argv + optind;
    if (!exit && n_words > 0 && strcmp(words[0], "help") == 0) { /* the same as --help */
        out->help = true;
        n_words--;
        words++;
    }
    if (exit || out->version || (out->help && n_words == 0)) {
        return exit;
    }
    exit = parse_words(n_words, words, out, fault);
    if (!exit) {
        exit = check_options(out, given, fault);
    }
    if (!exit) {
        exit = read_from(out, fault);
    }
    if (!exit) {
        exit = check_limits(out, fault);
    }
    return exit;
}
