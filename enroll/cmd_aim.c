/* aim: what the sensor sees, for who installs it, until interrupted. */
#include "enroll/commands.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

#include "core/contract.h"
#include "enroll/hint.h"
#include "enroll/report.h"
#include "enroll/state.h"

struct aim {
    bool json;
    bool rewrite; /* on a terminal one line is enough */
    int error;    /* of a signal that could not be read, or of the output */
};

static const char head[] =
    "capture           distance  right   down    yaw  pitch   roll  measured  fit  expr   mm/s  "
    "deg/s\n";

/* A number in a column; "-" for one that is not known. */
static void print_number(double value, int width, int digits, bool sign)
{
    if (isnan(value)) {
        printf("%*s", width, "-");
    } else {
        printf(sign ? "%+*.*f" : "%*.*f", width, digits, value);
    }
}

static void print_view(const json_t *view, bool rewrite)
{
    static const struct {
        const char *name;
        int width, digits;
        bool sign;
    } columns[] = {
        {"distance-mm", 10, 0, false}, {"right-mm", 7, 0, true},     {"down-mm", 7, 0, true},
        {"yaw-deg", 7, 0, true},       {"pitch-deg", 7, 0, true},    {"roll-deg", 7, 0, true},
        {"fit-coverage", 9, 2, false}, {"residual-mm", 6, 1, false}, {"expression", 6, 1, false},
        {"speed-mm-s", 7, 0, false},   {"speed-deg-s", 7, 0, false},
    };
    const char *word = cli_state_text(view, "capture");
    const char *hint = word ? cli_hint_text(word) : NULL;

    printf("%s%-16s", rewrite ? "\r\033[K" : "", word ? word : "?");
    for (size_t i = 0; i < sizeof columns / sizeof *columns; i++) {
        print_number(cli_state_real(view, columns[i].name), columns[i].width, columns[i].digits,
                     columns[i].sign);
    }
    /* A terminal's line holds no more than the numbers. */
    printf("%s%s%s", rewrite || !hint ? "" : "  ", rewrite || !hint ? "" : hint,
           rewrite ? "" : "\n");
}

static bool on_view(sd_bus_message *signal, void *context)
{
    struct aim *aim = context;
    json_t *view = NULL;

    aim->error = cli_state_read(signal, &view);
    if (aim->error) {
        return true;
    }
    if (aim->json) {
        (void)json_dumpf(view, stdout, JSON_COMPACT);
        (void)putchar('\n');
    } else {
        print_view(view, aim->rewrite);
    }
    json_decref(view);
    return fflush(stdout) == EOF;
}

/* To be interrupted is how it is meant to end. */
static enum cli_exit watch(struct cli_door *door, const struct cli_arguments *arguments,
                           struct aim *aim, struct cli_fault *fault)
{
    struct cli_fault ignored;
    enum cli_exit exit = cli_door_call(door, ISO_CONTRACT_AIM_START, NULL, fault);

    if (exit) {
        return exit;
    }
    if (!aim->json) {
        fputs(head, stdout);
    }
    exit = cli_door_wait(door, arguments->timeout_s, fault);
    if (aim->rewrite) {
        putchar('\n');
    }
    (void)!cli_door_call(door, ISO_CONTRACT_AIM_STOP, NULL, &ignored);
    if (aim->error) {
        return cli_door_bad_reply(aim->error, ISO_CONTRACT_VIEW, fault);
    }
    if (exit == CLI_EXIT_OK) {
        return cli_fault_set(fault, CLI_EXIT_FAULT, "output", "cannot write what is seen");
    }
    return exit == CLI_EXIT_INTERRUPTED || (exit == CLI_EXIT_TIMED_OUT && !fault->text[0])
               ? CLI_EXIT_OK
               : exit;
}

enum cli_exit cli_aim(struct cli_door *door, const struct cli_arguments *arguments,
                      struct cli_fault *fault)
{
    struct aim aim = {
        .json = arguments->json,
        .rewrite = !arguments->json && isatty(STDOUT_FILENO),
    };
    enum cli_exit exit = cli_door_catch_interrupt(door, fault);

    exit = exit ? exit : cli_door_subscribe(door, ISO_CONTRACT_VIEW, on_view, &aim, fault);
    return exit ? exit : watch(door, arguments, &aim, fault);
}
