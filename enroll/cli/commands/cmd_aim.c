/* aim: shows what the sensor sees, for its installation. It prints numbers until it is interrupted,
 * or saves one picture. */
#include "enroll/cli/commands/commands.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "enroll/cli/client/state.h"
#include "enroll/cli/picture/picture.h"
#include "enroll/cli/text/hint.h"
#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

/* The daemon sends some ten views a second, so a camera that is silent for this time has a
 * fault. */
static const double silence_s = 2;

struct aim {
    bool json;
    bool rewrite;     /* the output is a terminal, on which two lines are overwritten */
    char hint[32];    /* the word whose hint was printed last */
    uint64_t n_views; /* number of views that have come */
    int error;        /* a signal could not be read, or the output could not be written */
};

/* At most 79 columns, so that no terminal breaks a line. */
static const char head[] =
    "capture            dist right  down  yaw pitch roll  meas  fit expr  mm/s deg/s\n";

static const struct column {
    const char *name;
    int width, digits;
    bool sign;
} columns[] = {
    {"distance-mm", 7, 0, false},  {"right-mm", 6, 0, true},     {"down-mm", 6, 0, true},
    {"yaw-deg", 5, 0, true},       {"pitch-deg", 6, 0, true},    {"roll-deg", 5, 0, true},
    {"fit-coverage", 6, 2, false}, {"residual-mm", 5, 1, false}, {"expression", 5, 1, false},
    {"speed-mm-s", 6, 0, false},   {"speed-deg-s", 6, 0, false},
};

/* Prints a number in a column: "-" for an unknown number, ">" for one that does not fit. */
static void print_number(double value, const struct column *column)
{
    char text[32];
    const int length = isnan(value) ? snprintf(text, sizeof text, "-")
                                    : snprintf(text, sizeof text, column->sign ? "%+.*f" : "%.*f",
                                               column->digits, value);

    printf("%*s", column->width, length < column->width ? text : ">");
}

static void print_numbers(const json_t *view, const char *word)
{
    printf("%-16s", word ? word : "?");
    for (size_t i = 0; i < sizeof columns / sizeof *columns; i++) {
        print_number(cli_state_real(view, columns[i].name), &columns[i]);
    }
}

/* On a terminal the hint is below the numbers, and both lines are overwritten. In a file the hint
 * is a line of its own, which is written when the hint changes. */
static void print_view(const json_t *view, struct aim *aim)
{
    const char *word = cli_state_text(view, "capture");
    const char *hint = word ? cli_hint_text(word) : NULL;

    if (aim->rewrite) {
        fputs("\r\033[K", stdout);
        print_numbers(view, word);
        printf("\n\033[K  %s\033[A", hint ? hint : "");
        return;
    }
    print_numbers(view, word);
    putchar('\n');
    if (hint && strcmp(aim->hint, word) != 0) {
        printf("  %s\n", hint);
    }
    (void)snprintf(aim->hint, sizeof aim->hint, "%s", word ? word : "");
}

static bool on_view(sd_bus_message *signal, void *context)
{
    struct aim *aim = context;
    json_t *view = NULL;

    aim->n_views++;
    aim->error = cli_state_read(signal, &view);
    if (aim->error) {
        return true;
    }
    if (aim->json) {
        (void)json_dumpf(view, stdout, JSON_COMPACT);
        (void)putchar('\n');
    } else {
        print_view(view, aim);
    }
    json_decref(view);
    return fflush(stdout) == EOF;
}

static void say_silence(const struct aim *aim)
{
    if (aim->rewrite && aim->n_views > 0) {
        fputs("\n\n", stdout); /* go below both lines */
        fflush(stdout);
    }
    fputs("No frames arrive from the camera; isotherm doctor may say why.\n", stderr);
}

/* Waits as cli_daemon_wait() does, and prints a message once if nothing comes for a while. */
static enum cli_exit wait_for_views(struct cli_daemon *daemon, double timeout_s,
                                    const struct aim *aim, struct cli_fault *fault)
{
    const bool forever = timeout_s <= 0;
    bool said = false;

    for (double left_s = timeout_s; forever || left_s > 0; left_s -= silence_s) {
        const uint64_t before = aim->n_views;
        const bool whole = forever || left_s >= silence_s;
        const enum cli_exit exit = cli_daemon_wait(daemon, whole ? silence_s : left_s, fault);
        if (exit != CLI_EXIT_TIMED_OUT || fault->text[0]) {
            return exit;
        }
        if (whole && !said && aim->n_views == before) {
            say_silence(aim);
            said = true;
        }
    }
    return CLI_EXIT_TIMED_OUT;
}

/* Shows views until it is interrupted, which is its normal end. */
static enum cli_exit watch_views(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                                 struct aim *aim, struct cli_fault *fault)
{
    struct cli_fault ignored;
    enum cli_exit exit = cli_daemon_call(daemon, ISO_CONTRACT_AIM_START, NULL, fault);

    if (exit) {
        return exit;
    }
    if (!aim->json) {
        fputs(head, stdout);
    }
    exit = wait_for_views(daemon, arguments->timeout_s, aim, fault);
    if (aim->rewrite) {
        fputs("\n\n", stdout); /* go below both lines */
    }
    (void)!cli_daemon_call(daemon, ISO_CONTRACT_AIM_STOP, NULL, &ignored);
    if (aim->error) {
        return cli_daemon_bad_reply(aim->error, ISO_CONTRACT_VIEW, fault);
    }
    if (exit == CLI_EXIT_OK) {
        return cli_fault_set(fault, CLI_EXIT_FAULT, "output", "cannot write the output");
    }
    return exit == CLI_EXIT_INTERRUPTED || (exit == CLI_EXIT_TIMED_OUT && !fault->text[0])
               ? CLI_EXIT_OK
               : exit;
}

/* ---- one picture ---- */

static enum cli_exit save_picture(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                                  struct cli_fault *fault)
{
    uint8_t *png = NULL;
    size_t size = 0;
    enum cli_exit exit = cli_picture_take(daemon, &png, &size, fault);

    if (!exit) {
        exit = cli_picture_save(arguments->picture, png, size, fault);
    }
    free(png);
    if (exit) {
        return exit;
    }
    if (arguments->json) {
        return cli_report_json(
            json_pack("{s:s, s:I}", "picture", arguments->picture, "bytes", (json_int_t)size));
    }
    printf("%s: what the camera sees now; it shows who stands there, so delete it after use\n",
           arguments->picture);
    return CLI_EXIT_OK;
}

enum cli_exit cli_aim(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                      struct cli_fault *fault)
{
    struct aim aim = {
        .json = arguments->json,
        .rewrite = !arguments->json && isatty(STDOUT_FILENO),
    };

    if (arguments->picture) {
        return save_picture(daemon, arguments, fault);
    }
    enum cli_exit exit = cli_daemon_catch_interrupt(daemon, fault);

    if (!exit) {
        exit = cli_daemon_subscribe(daemon, ISO_CONTRACT_VIEW, on_view, &aim, fault);
    }
    return exit ? exit : watch_views(daemon, arguments, &aim, fault);
}
