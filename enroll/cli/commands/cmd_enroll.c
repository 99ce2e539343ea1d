#include "enroll/cli/commands/commands.h"

#include <math.h>
#include <string.h>
#include <time.h>

#include "drivers/terminal/progress.h"
#include "drivers/terminal/terminal.h"
#include "enroll/cli/arguments/limits.h"
#include "enroll/cli/client/action.h"
#include "enroll/cli/text/hint.h"
#include "enroll/cli/text/known.h"
#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

/* The daemon ends an enrolment after 60 s. If it has several poses, the daemon then keeps the
 * complete ones and reports this. In this case the tool waits longer, to receive the report. */
enum { QUICK_TIMEOUT_S = 60, POSES_TIMEOUT_S = 70, RESULT_SIZE = 64, WHAT_SIZE = 300 };

struct enrolment {
    const struct cli_arguments *arguments;
    struct cli_hints hints;   /* to stdout, or to stderr if stdout has a JSON document */
    char result[RESULT_SIZE]; /* the last word from the daemon that was not a hint */
    unsigned stage, stages;
    double quality;
    json_t *poses, *left_out;            /* arrays of the poses; NULL: none */
    struct cli_known known;              /* the enrolled person who has the name already */
    char refused[256];                   /* why the disk did not store it; "" if it did */
    char duplicate[CLI_KNOWN_NAME_SIZE]; /* name under which the face is known; "": unknown */
    struct iso_progress *progress;       /* on stderr, for each stage */
    char what[WHAT_SIZE];                /* text of the progress */
};

static int append_options(sd_bus_message *call, const struct cli_arguments *arguments)
{
    int r = sd_bus_message_open_container(call, 'a', "{sv}");

    if (r >= 0 && !arguments->quick) {
        r = sd_bus_message_append(call, "{sv}", ISO_CONTRACT_POSES, "b", 1);
    }
    if (r >= 0 && arguments->allow_duplicate) {
        r = sd_bus_message_append(call, "{sv}", ISO_CONTRACT_ALLOW_DUPLICATE, "b", 1);
    }
    if (r >= 0) {
        r = cli_limits_append(call, arguments);
    }
    return r < 0 ? r : sd_bus_message_close_container(call);
}

static int append_arguments(sd_bus_message *call, const void *context)
{
    const struct enrolment *enrolment = context;
    const int r = sd_bus_message_append(call, "s", enrolment->arguments->person);

    return r < 0 ? r : append_options(call, enrolment->arguments);
}

static void on_answered(sd_bus_message *reply, void *context)
{
    struct enrolment *enrolment = context;

    cli_known_read(reply, &enrolment->known);
}

/* The name of the person, as it is spelt in the gallery if it is there already. */
static const char *name_of(const struct enrolment *enrolment)
{
    return enrolment->known.person[0] ? enrolment->known.person : enrolment->arguments->person;
}

static void on_started(void *context)
{
    struct enrolment *enrolment = context;

    cli_known_say(&enrolment->known, time(NULL), enrolment->hints.out);
    fprintf(enrolment->hints.out, "Enrolling %s: look straight at the camera.\n",
            name_of(enrolment));
    (void)snprintf(enrolment->what, sizeof enrolment->what, "enrolling %s", name_of(enrolment));
    enrolment->progress = iso_progress_start(stderr, "isotherm", enrolment->what, 0, NULL);
}

/* Reads the last argument. It was added later than the others; an older daemon does not send it. */
static void read_detail(sd_bus_message *signal, const char *result, struct enrolment *enrolment)
{
    const char *detail;

    if (sd_bus_message_read(signal, "s", &detail) <= 0) {
        return;
    }
    if (strcmp(result, "enroll-" ISO_CONTRACT_RESULT_DUPLICATE) == 0) {
        (void)snprintf(enrolment->duplicate, sizeof enrolment->duplicate, "%s", detail);
    } else if (strcmp(result, "enroll-" ISO_CONTRACT_RESULT_NOT_STORED) == 0) {
        (void)snprintf(enrolment->refused, sizeof enrolment->refused, "%s", detail);
    }
}

/* Returns what the person has to do for a pose. The word of an unknown pose, of a later daemon, is
 * returned as it is. */
static const char *pose_text(const char *pose)
{
    static const struct {
        const char *pose, *text;
    } texts[] = {
        {ISO_CONTRACT_POSE_FRONTAL, "look straight at the camera"},
        {ISO_CONTRACT_POSE_LEFT, "turn your head a little to your left"},
        {ISO_CONTRACT_POSE_RIGHT, "turn your head a little to your right"},
        {ISO_CONTRACT_POSE_DOWN, "lower your chin a little"},
        {ISO_CONTRACT_POSE_UP, "lift your chin a little"},
    };

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        if (strcmp(texts[i].pose, pose) == 0) {
            return texts[i].text;
        }
    }
    return pose;
}

static void note_pose(json_t **poses, const char *pose)
{
    *poses = *poses ? *poses : json_array();
    (void)json_array_append_new(*poses, json_string(pose));
}

/* Handles the signal about a step. Before it prints, it removes the progress line. */
static void take_step(sd_bus_message *signal, struct enrolment *enrolment)
{
    const char *pose, *state;
    unsigned step, steps;
    double turn_deg;

    if (sd_bus_message_read(signal, "ssuud", &pose, &state, &step, &steps, &turn_deg) < 0) {
        return;
    }
    enrolment->hints.turn_deg = turn_deg;
    if (strcmp(state, ISO_CONTRACT_STEP_BEGUN) == 0) {
        enrolment->hints.last[0] = '\0';
        fprintf(enrolment->hints.out, "step %u of %u: %s\n", step, steps, pose_text(pose));
    } else if (strcmp(state, ISO_CONTRACT_STEP_PASSED) == 0) {
        note_pose(&enrolment->poses, pose);
    } else if (strcmp(state, ISO_CONTRACT_STEP_LEFT_OUT) == 0) {
        note_pose(&enrolment->left_out, pose);
        fprintf(enrolment->hints.out,
                "step %u of %u (%s) is left out: too few frames of this pose in time, or not of "
                "the same face\n",
                step, steps, pose);
    }
}

/* Handles a status and prints its meaning. The progress line is removed meanwhile. */
static bool take_status(sd_bus_message *signal, struct enrolment *enrolment)
{
    const char *result, *word;
    unsigned stage, stages;
    double quality;
    int done;

    if (sd_bus_message_read(signal, "sbuud", &result, &done, &stage, &stages, &quality) < 0) {
        return true; /* an empty result means "not understood" */
    }
    read_detail(signal, result, enrolment);
    enrolment->stage = stage;
    enrolment->stages = stages;
    if (cli_hint_is_retry(result, "enroll", &word)) {
        cli_hints_say(&enrolment->hints, word);
        return done;
    }
    (void)snprintf(enrolment->result, sizeof enrolment->result, "%s", result);
    if (strcmp(result, "enroll-" ISO_CONTRACT_RESULT_STAGE_MISFIT) == 0) {
        enrolment->hints.last[0] = '\0';
        fputs("this capture does not match the earlier ones: only one person can be enrolled\n",
              enrolment->hints.out);
    } else if (strcmp(result, "enroll-" ISO_CONTRACT_RESULT_STAGE_PASSED) == 0) {
        enrolment->hints.last[0] = '\0';
        enrolment->quality = quality;
        fprintf(enrolment->hints.out, "stage %u/%u done (quality %.2f)\n", stage, stages, quality);
    } else if (isfinite(quality) && quality > 0) {
        enrolment->quality = quality;
    }
    return done;
}

static bool is_signal(sd_bus_message *signal, const char *member)
{
    return sd_bus_message_is_signal(signal, ISO_CONTRACT_INTERFACE, member) > 0;
}

/* Any signal of the daemon. */
static bool on_signal(sd_bus_message *signal, void *context)
{
    struct enrolment *enrolment = context;
    const bool step = is_signal(signal, ISO_CONTRACT_ENROLL_STEP);
    bool done = false;

    if (!step && !is_signal(signal, ISO_CONTRACT_ENROLL_STATUS)) {
        return false;
    }
    iso_progress_pause(enrolment->progress);
    if (step) {
        take_step(signal, enrolment);
    } else {
        done = take_status(signal, enrolment);
    }
    fflush(enrolment->hints.out);
    iso_progress_resume(enrolment->progress);
    iso_progress_set(enrolment->progress, enrolment->stage, enrolment->stages);
    iso_progress_tick(enrolment->progress);
    return done;
}

static const struct outcome {
    const char *result;
    enum cli_exit exit;
    const char *text; /* follows the person's name */
} outcomes[] = {
    {"enroll-" ISO_CONTRACT_RESULT_COMPLETED, CLI_EXIT_OK, "is enrolled"},
    {"enroll-" ISO_CONTRACT_RESULT_DUPLICATE, CLI_EXIT_NO,
     "is not enrolled: this face is enrolled under another name (see --allow-duplicate)"},
    {"enroll-" ISO_CONTRACT_RESULT_FAILED, CLI_EXIT_NO,
     "is not enrolled: the captures did not agree with each other; try again, alone and holding "
     "still"},
    {"enroll-" ISO_CONTRACT_RESULT_OTHER_FACE, CLI_EXIT_NO,
     "is not enrolled: another face is enrolled under this name; choose "
     "another name, or remove that person first"},
    {"enroll-" ISO_CONTRACT_RESULT_NOT_STORED, CLI_EXIT_FAULT,
     "is not enrolled: the disk refused to store it; isotherm doctor says more"},
    {"enroll-" ISO_CONTRACT_RESULT_ATTACK, CLI_EXIT_NO,
     "is not enrolled: this looks like a picture, a screen or a mask"},
    {"enroll-" ISO_CONTRACT_RESULT_TIMED_OUT, CLI_EXIT_TIMED_OUT,
     "is not enrolled: no usable face in time"},
    {"enroll-" ISO_CONTRACT_RESULT_DISCONNECTED, CLI_EXIT_FAULT,
     "is not enrolled: the sensor has gone away"},
    {"interrupted", CLI_EXIT_INTERRUPTED, "is not enrolled: interrupted"},
};

static void print_outcome(const struct enrolment *enrolment, const struct outcome *outcome)
{
    const bool good = outcome->exit == CLI_EXIT_OK;
    const struct iso_terminal terminal = iso_terminal_of(good ? stdout : stderr);

    fputs(iso_terminal_paint(&terminal, good ? ISO_PAINT_GOOD : ISO_PAINT_BAD), terminal.out);
    if (enrolment->duplicate[0]) {
        fprintf(terminal.out,
                "%s is not enrolled: this face is enrolled as %s (see --allow-duplicate).",
                name_of(enrolment), enrolment->duplicate);
    } else if (enrolment->refused[0]) {
        fprintf(terminal.out, "%s is not enrolled: %s.", name_of(enrolment), enrolment->refused);
    } else {
        fprintf(terminal.out, "%s %s.", name_of(enrolment), outcome->text);
    }
    if (good && enrolment->left_out) {
        fprintf(terminal.out, " Poses that are left out:");
        for (size_t i = 0; i < json_array_size(enrolment->left_out); i++) {
            fprintf(terminal.out, " %s", json_string_value(json_array_get(enrolment->left_out, i)));
        }
        fprintf(terminal.out, ".");
    }
    fprintf(terminal.out, "%s\n", iso_terminal_paint(&terminal, ISO_PAINT_PLAIN));
}

/* Returns the array, which the caller releases, or an empty one. */
static json_t *take(json_t **poses)
{
    json_t *taken = *poses ? *poses : json_array();

    *poses = NULL;
    return taken;
}

static enum cli_exit report_enrolment(struct enrolment *enrolment, struct cli_fault *fault)
{
    const bool named = enrolment->duplicate[0] != '\0';

    for (size_t i = 0; i < sizeof outcomes / sizeof *outcomes; i++) {
        if (strcmp(enrolment->result, outcomes[i].result) != 0) {
            continue;
        }
        if (!enrolment->arguments->json) {
            print_outcome(enrolment, &outcomes[i]);
            return outcomes[i].exit;
        }
        const enum cli_exit written = cli_report_json(json_pack(
            "{s:s, s:s, s:i, s:i, s:f, s:o, s:o, s:s?, s:s?, s:I, s:o}", "person",
            name_of(enrolment), "result", enrolment->result, "stage", (int)enrolment->stage,
            "stages", (int)enrolment->stages, "quality", enrolment->quality, "poses",
            take(&enrolment->poses), "left_out", take(&enrolment->left_out), "duplicate_of",
            named ? enrolment->duplicate : NULL, "fault",
            enrolment->refused[0] ? enrolment->refused : NULL, "templates_before",
            (json_int_t)enrolment->known.templates, "hints", cli_hints_take(&enrolment->hints)));
        return written ? written : outcomes[i].exit;
    }
    return cli_fault_set(fault, CLI_EXIT_FAULT, "bad-reply",
                         "the daemon reported an unknown result of the enrolment ('%s')",
                         enrolment->result);
}

static void forget_json(const struct enrolment *enrolment)
{
    json_decref(enrolment->hints.said);
    json_decref(enrolment->poses);
    json_decref(enrolment->left_out);
}

/* Says what makes room if there is too little for the templates of a person. */
static void add_remedy(const struct cli_arguments *arguments, struct cli_fault *fault)
{
    const size_t used = strlen(fault->text);

    if (strcmp(fault->code, "gallery-full") == 0) {
        (void)snprintf(fault->text + used, sizeof fault->text - used, "; %sisotherm remove%s",
                       arguments->quick ? "" : "--quick adds one template and not five, ",
                       " NAME makes room");
    }
}

enum cli_exit cli_enroll(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault)
{
    struct enrolment enrolment = {
        .arguments = arguments,
        .hints.out = arguments->json ? stderr : stdout,
    };
    const double default_s = arguments->quick ? QUICK_TIMEOUT_S : POSES_TIMEOUT_S;
    const struct cli_action action = {
        .start = ISO_CONTRACT_ENROLL_START,
        .stop = ISO_CONTRACT_ENROLL_STOP,
        .signal = NULL, /* a status or a step */
        .append = append_arguments,
        .answered = on_answered,
        .started = on_started,
        .status = on_signal,
        .context = &enrolment,
        .timeout_s = arguments->timeout_s > 0 ? arguments->timeout_s : default_s,
    };

    enum cli_exit exit = cli_action_run(daemon, &action, fault);
    iso_progress_end(enrolment.progress);
    if (exit == CLI_EXIT_TIMED_OUT && !fault->text[0]) {
        strcpy(enrolment.result, "enroll-" ISO_CONTRACT_RESULT_TIMED_OUT);
    } else if (exit == CLI_EXIT_INTERRUPTED) {
        strcpy(enrolment.result, "interrupted");
    } else if (exit) {
        add_remedy(arguments, fault);
        forget_json(&enrolment);
        return exit;
    }
    exit = report_enrolment(&enrolment, fault);
    forget_json(&enrolment);
    return exit;
}
