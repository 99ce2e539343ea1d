/* identify and verify: two commands with the same steps. */
#include "enroll/cli/commands/commands.h"

#include <math.h>
#include <string.h>

#include "drivers/terminal/progress.h"
#include "drivers/terminal/terminal.h"
#include "enroll/cli/client/action.h"
#include "enroll/cli/text/hint.h"
#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

enum { DEFAULT_TIMEOUT_S = 30, WORD_SIZE = 64, NAME_SIZE = 256 };

struct recognition {
    const struct cli_arguments *arguments;
    const char *prefix;            /* the beginning of the result words: "identify" or "verify" */
    struct cli_hints hints;        /* to stdout, or to stderr if stdout has a JSON document */
    struct iso_progress *progress; /* on stderr: how long the camera has been looking */
    char result[WORD_SIZE];
    char person[NAME_SIZE]; /* the name from the daemon */
    double score, threshold;
};

static int append_person(sd_bus_message *call, const void *context)
{
    const struct recognition *recognition = context;

    return sd_bus_message_append(call, "s", recognition->arguments->person);
}

static void on_started(void *context)
{
    struct recognition *recognition = context;

    fputs("Look straight at the camera.\n", recognition->hints.out);
    recognition->progress = iso_progress_start(stderr, "isotherm", "looking for a face", 0, NULL);
}

/* Handles a status and prints its meaning. The progress line is removed meanwhile. */
static bool take_status(sd_bus_message *signal, struct recognition *recognition)
{
    const char *result, *person, *word;
    double score, threshold;
    int done;

    if (sd_bus_message_read(signal, "sbsdd", &result, &done, &person, &score, &threshold) < 0) {
        return true; /* an empty result means "not understood" */
    }
    if (cli_hint_is_retry(result, recognition->prefix, &word)) {
        cli_hints_say(&recognition->hints, word);
        return done;
    }
    (void)snprintf(recognition->result, sizeof recognition->result, "%s", result);
    (void)snprintf(recognition->person, sizeof recognition->person, "%s", person);
    recognition->score = score;
    recognition->threshold = threshold;
    return done;
}

static bool on_status(sd_bus_message *signal, void *context)
{
    struct recognition *recognition = context;

    iso_progress_pause(recognition->progress);
    const bool done = take_status(signal, recognition);
    fflush(recognition->hints.out);
    iso_progress_resume(recognition->progress);
    return done;
}

static json_t *finite_or_null(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static enum cli_exit report_json(struct recognition *recognition, bool scored)
{
    const char *person = recognition->person[0] ? recognition->person : NULL;

    return cli_report_json(
        json_pack("{s:s, s:s?, s:o, s:o, s:o}", "result", recognition->result, "person", person,
                  "score", scored ? finite_or_null(recognition->score) : json_null(), "threshold",
                  scored ? finite_or_null(recognition->threshold) : json_null(), "hints",
                  cli_hints_take(&recognition->hints)));
}

/* Prints a verdict in its colour, and the rest of the line without colour. */
static void print_verdict(bool good, const char *verdict, const char *name)
{
    const struct iso_terminal terminal = iso_terminal_of(stdout);

    printf("%s%s%s%s", iso_terminal_paint(&terminal, good ? ISO_PAINT_GOOD : ISO_PAINT_BAD),
           verdict, name, iso_terminal_paint(&terminal, ISO_PAINT_PLAIN));
}

static void report_text(const struct recognition *recognition, enum cli_exit exit, bool scored)
{
    const char *asked = recognition->arguments->person;

    if (exit == CLI_EXIT_OK) {
        print_verdict(true, "", recognition->person);
        printf(" (score %.2f, threshold %.2f)\n", recognition->score, recognition->threshold);
    } else if (exit == CLI_EXIT_NO && !scored) {
        print_verdict(false, "refused", "");
        puts(": this looks like a picture, a screen or a mask");
    } else if (scored) {
        print_verdict(false, asked ? "this is not " : "not known", asked ? asked : "");
        if (isfinite(recognition->score)) {
            printf(" (best score %.2f, threshold %.2f)", recognition->score,
                   recognition->threshold);
        }
        putchar('\n');
    } else if (exit == CLI_EXIT_TIMED_OUT) {
        fputs("no usable face in time\n", stderr);
    } else {
        fputs(exit == CLI_EXIT_FAULT ? "the sensor has gone away\n" : "interrupted\n", stderr);
    }
}

static enum cli_exit report_recognition(struct recognition *recognition, struct cli_fault *fault)
{
    static const struct {
        const char *suffix;
        enum cli_exit exit;
    } outcomes[] = {
        {"-" ISO_CONTRACT_RESULT_MATCH, CLI_EXIT_OK},
        {"-" ISO_CONTRACT_RESULT_NO_MATCH, CLI_EXIT_NO},
        {"-" ISO_CONTRACT_RESULT_ATTACK, CLI_EXIT_NO},
        {"-" ISO_CONTRACT_RESULT_TIMED_OUT, CLI_EXIT_TIMED_OUT},
        {"-" ISO_CONTRACT_RESULT_DISCONNECTED, CLI_EXIT_FAULT},
        {"-interrupted", CLI_EXIT_INTERRUPTED},
    };
    const size_t length = strlen(recognition->prefix);

    for (size_t i = 0; i < sizeof outcomes / sizeof *outcomes; i++) {
        if (strncmp(recognition->result, recognition->prefix, length) != 0 ||
            strcmp(recognition->result + length, outcomes[i].suffix) != 0) {
            continue;
        }
        const bool attack = strcmp(outcomes[i].suffix, "-" ISO_CONTRACT_RESULT_ATTACK) == 0;
        const bool scored = outcomes[i].exit == CLI_EXIT_OK ||
                            (outcomes[i].exit == CLI_EXIT_NO && !attack);
        if (recognition->arguments->json) {
            const enum cli_exit written = report_json(recognition, scored);
            return written ? written : outcomes[i].exit;
        }
        report_text(recognition, outcomes[i].exit, scored);
        return outcomes[i].exit;
    }
    return cli_fault_set(fault, CLI_EXIT_FAULT, "bad-reply",
                         "the daemon reported an unknown result ('%s')", recognition->result);
}

static enum cli_exit recognise_face(struct cli_daemon *daemon, struct recognition *recognition,
                                    struct cli_action *action, struct cli_fault *fault)
{
    const double timeout_s = recognition->arguments->timeout_s;
    const char *ending = NULL;

    recognition->hints.out = recognition->arguments->json ? stderr : stdout;
    action->started = on_started;
    action->status = on_status;
    action->context = recognition;
    action->timeout_s = timeout_s > 0 ? timeout_s : DEFAULT_TIMEOUT_S;

    enum cli_exit exit = cli_action_run(daemon, action, fault);
    iso_progress_end(recognition->progress);
    if (exit == CLI_EXIT_TIMED_OUT && !fault->text[0]) {
        ending = ISO_CONTRACT_RESULT_TIMED_OUT;
    } else if (exit == CLI_EXIT_INTERRUPTED) {
        ending = "interrupted";
    }
    if (ending) {
        (void)snprintf(recognition->result, sizeof recognition->result, "%s-%s",
                       recognition->prefix, ending);
    }
    exit = exit && !ending ? exit : report_recognition(recognition, fault);
    json_decref(recognition->hints.said);
    return exit;
}

enum cli_exit cli_identify(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                           struct cli_fault *fault)
{
    struct recognition recognition = {.arguments = arguments, .prefix = "identify"};
    struct cli_action action = {
        .start = ISO_CONTRACT_IDENTIFY_START,
        .stop = ISO_CONTRACT_IDENTIFY_STOP,
        .signal = ISO_CONTRACT_IDENTIFY_STATUS,
    };

    return recognise_face(daemon, &recognition, &action, fault);
}

enum cli_exit cli_verify(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault)
{
    struct recognition recognition = {.arguments = arguments, .prefix = "verify"};
    struct cli_action action = {
        .start = ISO_CONTRACT_VERIFY_START,
        .stop = ISO_CONTRACT_VERIFY_STOP,
        .signal = ISO_CONTRACT_VERIFY_STATUS,
        .append = append_person,
    };

    return recognise_face(daemon, &recognition, &action, fault);
}
