#include "enroll/cli/arguments/arguments.h"

#include <getopt.h>
#include <string.h>
#include <time.h>

#include "drivers/terminal/words.h"
#include "enroll/cli/arguments/log_event.h"
#include "enroll/cli/arguments/value.h"
#include "enroll/cli/arguments/when.h"
#include "enroll/cli/arguments/wrap.h"

#define FOR(verb) (1u << (verb))

static const struct verb {
    const char *name, *words, *summary;
} verbs[CLI_VERBS] = {
    [CLI_ENROLL] = {"enroll", "NAME", "enrol the person in front of the camera as NAME"},
    [CLI_IDENTIFY] = {"identify", "", "say who is in front of the camera"},
    [CLI_VERIFY] = {"verify", "NAME", "say whether NAME is in front of the camera"},
    [CLI_LIST] = {"list", "", "list the enrolled people"},
    [CLI_REMOVE] = {"remove", "NAME", "delete NAME and every template of NAME"},
    [CLI_VALIDITY] = {"validity", "NAME", "change from when and until when the door opens to NAME"},
    [CLI_RENAME] = {"rename", "OLD NEW", "give somebody who is enrolled another name"},
    [CLI_STATUS] = {"status", "", "show the state of the appliance"},
    [CLI_LOG] = {"log", "[verify]", "show the audit log, or say whether it is sound"},
    [CLI_DOCTOR] = {"doctor", "", "look for faults and say how to mend them"},
    [CLI_AIM] = {"aim", "", "show what the sensor sees, to place and turn it"},
    [CLI_EXPORT] = {"export", "FILE", "write people into a sealed file, for another door"},
    [CLI_IMPORT] = {"import", "FILE", "take people over from such a file"},
    [CLI_KEY] = {"key", "rotate|address", "seal everything with new keys; show the address"},
    [CLI_LOCKDOWN] = {"lockdown", "on|off", "let nobody in, whoever it is, until it is off"},
    [CLI_LOCKOUT] = {"lockout", "clear", "end a lock-out after failures, and forget them"},
    [CLI_SETUP] = {"setup", "", "find camera and board, configure the daemon and start it"},
    [CLI_DOOR] = {"door", "test", "have the relay click once, for half a second"},
};

enum option_id {
    OPTION_JSON = 256, /* above every character, which getopt returns too */
    OPTION_BUS,
    OPTION_SESSION,
    OPTION_HELP,
    OPTION_VERSION,
    OPTION_TIMEOUT,
    OPTION_ALLOW_DUPLICATE,
    OPTION_VALID_FROM,
    OPTION_VALID_UNTIL,
    OPTION_FROM,
    OPTION_UNTIL,
    OPTION_NONE,
    OPTION_EXPIRED,
    OPTION_COUNT,
    OPTION_FOLLOW,
    OPTION_HEAD,
    OPTION_ADDRESS,
    OPTION_PASSPHRASE_FILE,
    OPTION_PERSON,
    OPTION_REPLACE,
    OPTION_PICTURE,
    OPTION_SENSOR,
    OPTION_BOARD,
    OPTION_YES,
    OPTION_DRY_RUN,
    OPTION_DAY,
    OPTION_EVENT,
    OPTION_CSV,
    OPTION_FULL,
};

/* What an option does for one command. */
struct help_part {
    enum cli_verb verb;
    const char *text;
};

static const struct help_part timeout_help[] = {
    {CLI_ENROLL, "give up after S seconds (60)"},
    {CLI_IDENTIFY, "give up after S seconds (30)"},
    {CLI_VERIFY, "give up after S seconds (30)"},
    {CLI_AIM, "end after S seconds (never)"},
    {CLI_VERBS, NULL},
};
static const struct help_part from_help[] = {
    {CLI_LOG, "begin at record N"},
    {CLI_VALIDITY, "the door opens from T on, or none"},
    {CLI_VERBS, NULL},
};
static const struct help_part address_help[] = {
    {CLI_EXPORT, "who can open it"},
    {CLI_IMPORT, "who has to have signed it"},
    {CLI_VERBS, NULL},
};
static const struct help_part picture_help[] = {
    {CLI_AIM, "write one picture of what the camera sees, as PNG, and end"},
    {CLI_SETUP, "write one picture of what the camera sees, as PNG"},
    {CLI_VERBS, NULL},
};

static const struct choice {
    const char *name;
    const char *argument; /* NULL: it takes none */
    enum option_id id;
    unsigned verbs;                /* of FOR(); 0: common to all, and to none */
    const char *help;              /* NULL: it differs between commands */
    const struct help_part *parts; /* then these, one a command; ended by a NULL text */
} choices[] = {
    {"timeout", "S", OPTION_TIMEOUT,
     FOR(CLI_ENROLL) | FOR(CLI_IDENTIFY) | FOR(CLI_VERIFY) | FOR(CLI_AIM), NULL, timeout_help},
    {"allow-duplicate", NULL, OPTION_ALLOW_DUPLICATE, FOR(CLI_ENROLL),
     "enrol even if this face is known under another name", NULL},
    {"valid-from", "T", OPTION_VALID_FROM, FOR(CLI_ENROLL), "the door opens to NAME from T on",
     NULL},
    {"valid-until", "T", OPTION_VALID_UNTIL, FOR(CLI_ENROLL),
     "... and until T: 2026-12-31, 2026-12-31T18:00 or none", NULL},
    {"from", "N|T", OPTION_FROM, FOR(CLI_LOG) | FOR(CLI_VALIDITY), NULL, from_help},
    {"until", "T", OPTION_UNTIL, FOR(CLI_VALIDITY), "... and until T: 2026-12-31, or none", NULL},
    {"none", NULL, OPTION_NONE, FOR(CLI_VALIDITY), "the door opens at all times", NULL},
    {"expired", NULL, OPTION_EXPIRED, FOR(CLI_ENROLL) | FOR(CLI_VALIDITY),
     "an end in the past is meant: the door does not open any more", NULL},
    {"count", "N", OPTION_COUNT, FOR(CLI_LOG), "also -n N: at most N records (20; the last ones)",
     NULL},
    {"follow", NULL, OPTION_FOLLOW, FOR(CLI_LOG), "go on with new records until interrupted", NULL},
    {"head", "N:HEX", OPTION_HEAD, FOR(CLI_LOG),
     "verify: what an earlier verify gave, to find a log that was put back", NULL},
    {"address", "A", OPTION_ADDRESS, FOR(CLI_EXPORT) | FOR(CLI_IMPORT), NULL, address_help},
    {"passphrase-file", "F", OPTION_PASSPHRASE_FILE, FOR(CLI_EXPORT) | FOR(CLI_IMPORT),
     "take the passphrase from the first line of F", NULL},
    {"person", "NAME", OPTION_PERSON, FOR(CLI_EXPORT) | FOR(CLI_LOG),
     "only this one; may be repeated", NULL},
    {"day", "D", OPTION_DAY, FOR(CLI_LOG), "only that day: 2026-12-31, today or yesterday", NULL},
    {"event", "E,E,...", OPTION_EVENT, FOR(CLI_LOG), "only such events: visit,door", NULL},
    {"csv", NULL, OPTION_CSV, FOR(CLI_LOG), "comma-separated values, with a head", NULL},
    {"full", NULL, OPTION_FULL, FOR(CLI_LOG), "every member of a record, and every digit", NULL},
    {"replace", NULL, OPTION_REPLACE, FOR(CLI_IMPORT), "replace people who are known here", NULL},
    {"picture", "FILE", OPTION_PICTURE, FOR(CLI_AIM) | FOR(CLI_SETUP), NULL, picture_help},
    {"sensor", "WORD", OPTION_SENSOR, FOR(CLI_SETUP),
     "the sensor: openni2, v4l2:/dev/video0, replay:/DIRECTORY, ...", NULL},
    {"board", "NAME", OPTION_BOARD, FOR(CLI_SETUP), "the board that has the door's lines", NULL},
    {"yes", NULL, OPTION_YES, FOR(CLI_SETUP) | FOR(CLI_DOOR), "ask nothing", NULL},
    {"dry-run", NULL, OPTION_DRY_RUN, FOR(CLI_SETUP), "show the file and change nothing", NULL},
    {"json", NULL, OPTION_JSON, 0, "one JSON document on stdout, remarks on stderr", NULL},
    {"bus", "ADDRESS", OPTION_BUS, 0, "the message bus to use, not the system bus", NULL},
    {"session", NULL, OPTION_SESSION, 0, "use the session bus", NULL},
    {"help", NULL, OPTION_HELP, 0, "also -h: show this help (after a command: its own)", NULL},
    {"version", NULL, OPTION_VERSION, 0, "show the version", NULL},
};

enum { HELP_SIZE = 256 };

enum { CHOICES = sizeof choices / sizeof *choices };

/* Every "--json", even one behind a fault that ends the parsing. */
static bool wants_json(int argc, char **argv)
{
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
        if (strcmp(argv[i], "--json") == 0) {
            return true;
        }
    }
    return false;
}

/* Those of export, import and log verify. */
static bool take_transfer(struct cli_arguments *out, enum option_id id, const char *value)
{
    switch (id) {
    case OPTION_HEAD:
        out->head = value;
        return *value != '\0';
    case OPTION_ADDRESS:
        out->address = value;
        return *value != '\0';
    case OPTION_PASSPHRASE_FILE:
        out->passphrase_file = value;
        return *value != '\0';
    case OPTION_PERSON:
        if (out->n_people == CLI_PEOPLE_MAX) {
            return false;
        }
        out->people[out->n_people++] = value;
        return *value != '\0';
    case OPTION_REPLACE:
        out->replace = true;
        return true;
    default:
        return false;
    }
}

/* Those that choose and show records of the log. */
static bool take_log(struct cli_arguments *out, enum option_id id, const char *value)
{
    switch (id) {
    case OPTION_DAY:
        return cli_when_parse_day(value, time(NULL), &out->day_begins_s, &out->day_ends_s);
    case OPTION_EVENT:
        out->events = value;
        return *value != '\0';
    case OPTION_CSV:
        out->csv = true;
        return true;
    case OPTION_FULL:
        out->full = true;
        return true;
    default:
        return take_transfer(out, id, value);
    }
}

/* A limit: a point in time, or the word for none. */
static bool parse_limit(const char *text, bool end_of_day, bool *named, int64_t *unix_s)
{
    *named = true;
    if (strcmp(text, "none") == 0) {
        *unix_s = 0;
        return true;
    }
    return cli_when_parse(text, end_of_day, unix_s);
}

/* Those of the limits of a person. */
static bool take_limit(struct cli_arguments *out, enum option_id id, const char *value)
{
    switch (id) {
    case OPTION_VALID_FROM:
        return parse_limit(value, false, &out->names_from, &out->valid_from_s);
    case OPTION_VALID_UNTIL:
    case OPTION_UNTIL:
        return parse_limit(value, true, &out->names_until, &out->valid_until_s);
    case OPTION_NONE:
        out->none = true;
        return true;
    case OPTION_EXPIRED:
        out->expired = true;
        return true;
    default:
        return take_log(out, id, value);
    }
}

/* Those of setup. */
static bool take_setup(struct cli_arguments *out, enum option_id id, const char *value)
{
    switch (id) {
    case OPTION_SENSOR:
        out->sensor = value;
        return *value != '\0';
    case OPTION_BOARD:
        out->board = value;
        return *value != '\0';
    case OPTION_YES:
        out->yes = true;
        return true;
    case OPTION_DRY_RUN:
        out->dry_run = true;
        return true;
    default:
        return take_limit(out, id, value);
    }
}

/* Takes one option that belongs to the table; false if its value is bad. */
static bool take(struct cli_arguments *out, enum option_id id, const char *value)
{
    unsigned long long number = 0;

    switch (id) {
    case OPTION_JSON:
        return true; /* wants_json() has seen it */
    case OPTION_BUS:
        out->bus.address = value;
        return *value != '\0';
    case OPTION_SESSION:
        out->bus.session = true;
        return true;
    case OPTION_HELP:
        out->help = true;
        return true;
    case OPTION_VERSION:
        out->version = true;
        return true;
    case OPTION_TIMEOUT:
        return cli_value_seconds(value, &out->timeout_s);
    case OPTION_ALLOW_DUPLICATE:
        out->allow_duplicate = true;
        return true;
    case OPTION_FROM:
        out->from_text = value; /* what it has to be depends on the command */
        return true;
    case OPTION_COUNT:
        return cli_value_count(value, 100000, &number) && (out->count = (unsigned)number, true);
    case OPTION_FOLLOW:
        out->follow = true;
        return true;
    case OPTION_PICTURE:
        out->picture = value;
        return *value != '\0';
    default:
        return take_setup(out, id, value);
    }
}

static const struct choice *find_choice(int id)
{
    for (size_t i = 0; i < CHOICES; i++) {
        if ((int)choices[i].id == id) {
            return &choices[i];
        }
    }
    return NULL;
}

static void make_getopt_table(struct option table[CHOICES + 1])
{
    for (size_t i = 0; i < CHOICES; i++) {
        table[i] = (struct option){choices[i].name, choices[i].argument != NULL, NULL,
                                   (int)choices[i].id};
    }
    table[CHOICES] = (struct option){0};
}

static enum cli_exit usage(struct cli_fault *fault, const char *text, const char *word)
{
    return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "%s '%s' (see isotherm --help)", text,
                         word);
}

static const char *next_option(size_t index, const void *context)
{
    (void)context;
    return index < CHOICES ? choices[index].name : NULL;
}

static const char *next_verb(size_t index, const void *context)
{
    (void)context;
    return index < CLI_VERBS ? verbs[index].name : NULL;
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
    return usage(fault, "unknown option, or one that takes no value:", word);
}

static enum cli_exit unknown_command(struct cli_fault *fault, const char *word)
{
    const char *meant = iso_words_nearest(word, next_verb, NULL);

    return meant ? cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                                 "unknown command '%s': did you mean '%s'?", word, meant)
                 : usage(fault, "unknown command", word);
}

/* What a good value looks like, behind the complaint about a bad one, by the name of the argument.
 */
static const char *example_of(const char *argument)
{
    if (strcmp(argument, "T") == 0) {
        return "; a time looks like 2026-12-31, 2026-12-31T18:00 or 2026-12-31T18:00Z (UTC)";
    }
    return strcmp(argument, "D") == 0 ? "; a day looks like 2026-12-31, today or yesterday" : "";
}

/* Reads the options, notes in *given which were there (a bit for each of the table). */
static enum cli_exit parse_options(int argc, char **argv, struct cli_arguments *out,
                                   uint64_t *given, struct cli_fault *fault)
{
    struct option table[CHOICES + 1];
    int id;

    make_getopt_table(table);
    opterr = 0;
    optind = 0; /* GNU: begin anew, also after an earlier call */
    while ((id = getopt_long(argc, argv, ":hn:", table, NULL)) != -1) {
        if (id == '?') {
            return unknown_option(fault, argv[optind - 1]);
        }
        if (id == ':') {
            return usage(fault, "a value is missing after", argv[optind - 1]);
        }
        const struct choice *choice = find_choice(id == 'n'   ? OPTION_COUNT
                                                  : id == 'h' ? OPTION_HELP
                                                              : id);
        if (!take(out, choice->id, optarg)) {
            return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "--%s: bad value '%s'%s",
                                 choice->name, optarg, example_of(choice->argument));
        }
        *given |= UINT64_C(1) << (choice - choices);
    }
    return CLI_EXIT_OK;
}

/* A command's fixed words, "on|off", as they are read out: "on or off". */
static enum cli_exit missing_word(const struct verb *verb, const char *after,
                                  struct cli_fault *fault)
{
    const char *takes = verb->words, *bar = strchr(takes, '|');

    if (strpbrk(takes, "ABCDEFGHIJKLMNOPQRSTUVWXYZ")) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "a %s is missing after '%s' (see isotherm --help)",
                             strchr(takes, ' ') ? "word" : takes, after);
    }
    return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "'%s' needs a word: %.*s%s%s", verb->name,
                         (int)strcspn(takes, "|"), takes, bar ? " or " : "", bar ? bar + 1 : "");
}

static enum cli_exit parse_words(int n_words, char **words, struct cli_arguments *out,
                                 struct cli_fault *fault)
{
    if (n_words == 0) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "no command given (see isotherm --help)");
    }
    for (out->verb = 0; out->verb < CLI_VERBS; out->verb++) {
        if (strcmp(words[0], verbs[out->verb].name) == 0) {
            break;
        }
    }
    if (out->verb == CLI_VERBS) {
        return unknown_command(fault, words[0]);
    }
    const char *takes = verbs[out->verb].words;
    const int most = 1 + (*takes != '\0') + (strchr(takes, ' ') != NULL);
    const int least = *takes == '[' ? 1 : most;
    if (n_words < least && !out->help) {
        return missing_word(&verbs[out->verb], words[n_words - 1], fault);
    }
    if (n_words > most) {
        return usage(fault, "superfluous word", words[most]);
    }
    out->word = n_words > 1 ? words[1] : NULL;
    out->person = out->word;
    out->name = n_words > 2 ? words[2] : NULL;
    return CLI_EXIT_OK;
}

/* --from is a number for log, and a point in time for validity. */
static enum cli_exit parse_from(struct cli_arguments *out, struct cli_fault *fault)
{
    unsigned long long number = 0;
    const char *text = out->from_text;
    bool good = true;

    if (text && out->verb == CLI_LOG) {
        good = cli_value_count(text, UINT64_MAX, &number);
    } else if (text) {
        good = parse_limit(text, false, &out->names_from, &out->valid_from_s);
    }
    out->from = number;
    return good ? CLI_EXIT_OK
                : cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "--from: bad value '%s'%s", text,
                                example_of(out->verb == CLI_LOG ? "N" : "T"));
}

/* Which limits there are, and that they go together. */
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
    for (size_t i = 0; i < CHOICES; i++) {
        if ((given & UINT64_C(1) << i) && choices[i].verbs &&
            !(choices[i].verbs & FOR(arguments->verb))) {
            return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "%s takes no --%s",
                                 verbs[arguments->verb].name, choices[i].name);
        }
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
    if (!exit && n_words > 0 && strcmp(words[0], "help") == 0) { /* as the option */
        out->help = true;
        n_words--;
        words++;
    }
    if (exit || out->version || (out->help && n_words == 0)) {
        return exit;
    }
    exit = parse_words(n_words, words, out, fault);
    exit = exit ? exit : check_options(out, given, fault);
    exit = exit ? exit : parse_from(out, fault);
    return exit ? exit : check_limits(out, fault);
}

/* What an option does for this command; for CLI_VERBS "log: ...; validity: ...". */
static void write_help(const struct choice *choice, enum cli_verb verb, char *text, size_t size)
{
    size_t used = 0;

    (void)snprintf(text, size, "%s", choice->help ? choice->help : "");
    for (const struct help_part *part = choice->parts; part && part->text; part++) {
        if (part->verb == verb) {
            (void)snprintf(text, size, "%s", part->text);
            return;
        }
        if (verb == CLI_VERBS && used < size) {
            const int n = snprintf(text + used, size - used, "%s%s: %s", used ? "; " : "",
                                   verbs[part->verb].name, part->text);
            used += n > 0 ? (size_t)n : 0;
        }
    }
}

static void help_option(const struct choice *choice, enum cli_verb verb, FILE *out)
{
    char left[40], part[HELP_SIZE];

    (void)snprintf(left, sizeof left, "--%s%s%s", choice->name, choice->argument ? " " : "",
                   choice->argument ? choice->argument : "");
    const int column = fprintf(out, "  %-19s ", left);
    write_help(choice, verb, part, sizeof part);
    cli_wrap(part, column, out);
}

void cli_arguments_help(enum cli_verb verb, FILE *out)
{
    if (verb == CLI_VERBS) {
        fputs("Usage: isotherm [OPTION...] COMMAND\n"
              "A client of the face recognition appliance isothermd.\n\nCommands:\n",
              out);
        for (size_t i = 0; i < CLI_VERBS; i++) {
            const int column = fprintf(out, "  %-8s %-14s ", verbs[i].name, verbs[i].words);
            cli_wrap(verbs[i].summary, column, out);
        }
    } else {
        fprintf(out, "Usage: isotherm %s%s%s [OPTION...]\n%c%s.\n", verbs[verb].name,
                *verbs[verb].words ? " " : "", verbs[verb].words,
                verbs[verb].summary[0] - 'a' + 'A', verbs[verb].summary + 1);
    }
    fputs("\nOptions:\n", out);
    for (size_t i = 0; i < CHOICES; i++) {
        if (choices[i].verbs == 0 || (verb < CLI_VERBS && (choices[i].verbs & FOR(verb)))) {
            help_option(&choices[i], verb, out);
        }
    }
    if (verb == CLI_VERBS) {
        fputs("\n`isotherm COMMAND --help` lists a command's own options.\n", out);
    }
    fputs("\nExit status: 0 yes or done, 1 no match or refused, 2 usage, 3 no such thing,\n"
          "4 device, daemon or data fault, 5 timed out.\n",
          out);
}
