#include "enroll/cli/doctor/diagnosis.h"

#include <string.h>

#include "drivers/terminal/terminal.h"
#include "drivers/terminal/words.h"
#include "enroll/cli/client/state.h"
#include "enroll/cli/doctor/remedy.h"
#include "firmware/contract/contract.h"

static const char *const check_names[] = {
    [CLI_CHECK_GOOD] = "ok",
    [CLI_CHECK_ODD] = "warning",
    [CLI_CHECK_DENIED] = "denied",
    [CLI_CHECK_BAD] = "fault",
};

void cli_diagnosis_add(struct cli_diagnosis *diagnosis, const char *subject, enum cli_check check,
                       enum iso_fault_code code, const char *found)
{
    if (diagnosis->n_findings == CLI_FINDINGS_MAX) {
        return;
    }
    struct cli_finding *finding = &diagnosis->findings[diagnosis->n_findings++];
    finding->subject = subject;
    finding->check = check;
    finding->code = code;
    (void)snprintf(finding->found, sizeof finding->found, "%s",
                   *found ? found : iso_fault_code_meaning(code));
}

static void add_good(struct cli_diagnosis *diagnosis, const char *subject, const char *found)
{
    cli_diagnosis_add(diagnosis, subject, CLI_CHECK_GOOD, ISO_FAULT_NONE, found);
}

/* Reads the code from the daemon. An unknown code of a newer daemon counts as none, and its text is
 * shown without a remedy. */
static enum iso_fault_code code_of(const json_t *state, const char *key)
{
    const char *name = cli_state_text(state, key);
    enum iso_fault_code code = ISO_FAULT_NONE;

    return name && iso_fault_code_find(name, &code) ? code : ISO_FAULT_NONE;
}

static void judge_version(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *version = cli_state_text(state, "version");
    const bool same = version && strcmp(version, ISOTHERM_VERSION) == 0;
    char found[128];

    if (same) {
        add_good(diagnosis, "version", version);
        return;
    }
    (void)snprintf(found, sizeof found, "%.64s, this client: " ISOTHERM_VERSION,
                   version ? version : "not reported");
    cli_diagnosis_add(diagnosis, "version", CLI_CHECK_ODD, ISO_FAULT_VERSION_DIFFERS, found);
}

/* Judges a sensor that runs. Its driver may report why frames do not arrive. An older daemon does
 * not have this key. */
static void judge_running_sensor(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *health = cli_state_text(state, "sensor-health");
    const bool never = cli_state_number(state, "frames", 0) == 0;
    char found[256];

    if (!health || !*health) {
        add_good(diagnosis, "sensor", "started");
        return;
    }
    (void)snprintf(found, sizeof found, "started: %s%s", health,
                   never ? ", and no frame has arrived yet" : "");
    cli_diagnosis_add(diagnosis, "sensor", CLI_CHECK_ODD, code_of(state, "sensor-health-code"),
                      found);
}

static void judge_sensor(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *word = cli_state_text(state, "sensor-state");
    const char *cause = cli_state_text(state, "sensor-fault");
    char found[256];

    if (word && strcmp(word, "started") == 0) {
        judge_running_sensor(diagnosis, state);
        return;
    }
    (void)snprintf(found, sizeof found, "%s%s%s", word ? word : "not reported",
                   cause && *cause ? ": " : "", cause ? cause : "");
    cli_diagnosis_add(diagnosis, "sensor", CLI_CHECK_BAD,
                      word ? code_of(state, "sensor-fault-code") : ISO_FAULT_NO_STATUS, found);
}

/* A text from the daemon with its code. If both are empty, there is no finding. */
struct told {
    const char *subject, *text, *code; /* the keys in the status */
    enum cli_check with_code, without_code;
};

static void judge_told(struct cli_diagnosis *diagnosis, const json_t *state,
                       const struct told *told)
{
    const enum iso_fault_code code = code_of(state, told->code);
    const char *text = cli_state_text(state, told->text);

    if (code != ISO_FAULT_NONE) {
        cli_diagnosis_add(diagnosis, told->subject, told->with_code, code, text ? text : "");
    } else if (text && *text) {
        cli_diagnosis_add(diagnosis, told->subject, told->without_code, code, text);
    }
}

/* Judges whether the door is in service: under lockdown or locked out it admits nobody. */
static void judge_service(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const json_int_t left_ms = cli_state_number(state, "lockout-ms", 0);
    char found[96];

    if (json_is_true(json_object_get(state, "lockdown"))) {
        cli_diagnosis_add(diagnosis, "service", CLI_CHECK_BAD, ISO_FAULT_LOCKDOWN,
                          "lockdown: the door admits nobody");
    } else if (left_ms > 0) {
        (void)snprintf(found, sizeof found,
                       "locked out: the door admits nobody for another %" JSON_INTEGER_FORMAT " s",
                       (left_ms + 999) / 1000);
        cli_diagnosis_add(diagnosis, "service", CLI_CHECK_BAD, ISO_FAULT_LOCKED_OUT, found);
    }
}

static void judge_door(struct cli_diagnosis *diagnosis, const json_t *state)
{
    static const struct {
        const char *word;
        enum cli_check check;
        enum iso_fault_code code;
    } states[] = {
        {"locked", CLI_CHECK_GOOD, ISO_FAULT_NONE},
        {"unlocked", CLI_CHECK_GOOD, ISO_FAULT_NONE},
        {"opened", CLI_CHECK_GOOD, ISO_FAULT_NONE},
        {"held-open", CLI_CHECK_ODD, ISO_FAULT_DOOR_HELD_OPEN},
        {"forced", CLI_CHECK_BAD, ISO_FAULT_DOOR_FORCED},
        {"fault", CLI_CHECK_BAD, ISO_FAULT_DOOR_AT_FAULT},
    };
    const char *word = cli_state_text(state, "door-state");

    for (size_t i = 0; word && i < sizeof states / sizeof *states; i++) {
        if (strcmp(word, states[i].word) == 0) {
            cli_diagnosis_add(diagnosis, "door", states[i].check, states[i].code, word);
            return;
        }
    }
    cli_diagnosis_add(diagnosis, "door", CLI_CHECK_BAD, ISO_FAULT_NO_STATUS,
                      word ? word : "not reported");
}

static void judge_lines(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *back_end = cli_state_text(state, "door");
    const char *fault = cli_state_text(state, "door-fault");
    const char *lines = cli_state_text(state, "door-lines");
    char found[256];

    if (!back_end || !fault) {
        cli_diagnosis_add(diagnosis, "lines", CLI_CHECK_BAD, ISO_FAULT_NO_STATUS, "not reported");
    } else if (*fault) {
        cli_diagnosis_add(diagnosis, "lines", CLI_CHECK_BAD, code_of(state, "door-fault-code"),
                          fault);
    } else if (strcmp(back_end, "null") == 0) {
        cli_diagnosis_add(diagnosis, "lines", CLI_CHECK_ODD, ISO_FAULT_DOOR_UNWIRED,
                          "null: nothing is switched");
    } else {
        (void)snprintf(found, sizeof found, "%s%s%s", back_end, lines && *lines ? ": " : "",
                       lines ? lines : "");
        add_good(diagnosis, "lines", found);
    }
}

/* Reports nothing if the priority is right, or if an older daemon does not have this key. */
static void judge_priority(struct cli_diagnosis *diagnosis, const json_t *state)
{
    if (json_is_false(json_object_get(state, "door-realtime"))) {
        cli_diagnosis_add(diagnosis, "door thread", CLI_CHECK_ODD, ISO_FAULT_NOT_REALTIME,
                          "no real-time priority: the door may be late on a busy machine");
    }
}

static void judge_model(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *model = cli_state_text(state, "model");

    if (model && *model) {
        add_good(diagnosis, "model", model);
    } else {
        cli_diagnosis_add(diagnosis, "model", CLI_CHECK_BAD, ISO_FAULT_MODEL_ABSENT, "not loaded");
    }
}

static void judge_gallery(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const json_int_t people = cli_state_number(state, "people", -1);
    const json_int_t templates = cli_state_number(state, "templates-usable", -1);
    const json_int_t valid = cli_state_number(state, "people-valid", people);
    char found[128];

    if (people < 0) {
        cli_diagnosis_add(diagnosis, "gallery", CLI_CHECK_BAD, ISO_FAULT_NO_STATUS, "not reported");
        return;
    }
    (void)snprintf(found, sizeof found,
                   "%" JSON_INTEGER_FORMAT " %s, %" JSON_INTEGER_FORMAT " usable %s", people,
                   iso_plural((uint64_t)people, "person", "people"), templates,
                   iso_plural((uint64_t)templates, "template", "templates"));
    if (people == 0) {
        cli_diagnosis_add(diagnosis, "gallery", CLI_CHECK_ODD, ISO_FAULT_GALLERY_EMPTY, found);
    } else if (valid == 0) {
        (void)snprintf(found, sizeof found,
                       "%" JSON_INTEGER_FORMAT " people, none of whom is valid at this time",
                       people);
        cli_diagnosis_add(diagnosis, "gallery", CLI_CHECK_BAD, ISO_FAULT_NOBODY_VALID, found);
    } else if (templates < people) {
        cli_diagnosis_add(diagnosis, "gallery", CLI_CHECK_ODD, ISO_FAULT_TEMPLATES_OLD, found);
    } else {
        add_good(diagnosis, "gallery", found);
    }
}

/* Checks whether the metric has adapted to the people, if the configuration asks for it. Reports
 * nothing if the daemon is older and does not have this key. */
static void judge_site(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *word = cli_state_text(state, "site");
    const json_int_t people = cli_state_number(state, "site-people", 0);
    const json_int_t least = cli_state_number(state, "site-least", 0);
    char found[128];

    if (word && strcmp(word, ISO_CONTRACT_SITE_ADAPTED) == 0) {
        (void)snprintf(found, sizeof found, "adapted to %" JSON_INTEGER_FORMAT " people", people);
        add_good(diagnosis, "metric", found);
    } else if (word && strcmp(word, ISO_CONTRACT_SITE_PROVISIONAL) == 0) {
        (void)snprintf(found, sizeof found,
                       "provisional: learned from %" JSON_INTEGER_FORMAT
                       " of the %" JSON_INTEGER_FORMAT " people that it needs",
                       people, least);
        cli_diagnosis_add(diagnosis, "metric", CLI_CHECK_ODD, ISO_FAULT_SITE_PROVISIONAL, found);
    } else if (word) {
        add_good(diagnosis, "metric", "as shipped: adapt = no");
    }
}

/* Reports nothing if an older daemon does not have this key. */
static void judge_image_check(struct cli_diagnosis *diagnosis, const json_t *state)
{
    const char *word = cli_state_text(state, "image-check");
    const bool absent = word && strcmp(word, "absent") == 0;

    if (word) {
        cli_diagnosis_add(diagnosis, "image check", absent ? CLI_CHECK_ODD : CLI_CHECK_GOOD,
                          absent ? ISO_FAULT_IMAGE_CHECK_ABSENT : ISO_FAULT_NONE, word);
    }
}

/* The judgements in the order of the output. Each row is a function, or a text from the daemon. */
static const struct judgement {
    void (*judge)(struct cli_diagnosis *diagnosis, const json_t *state);
    struct told told;
} judgements[] = {
    {.judge = judge_version},
    {.judge = judge_sensor},
    {.told = {"devices", "sensor-devices", "sensor-devices-code", CLI_CHECK_ODD, CLI_CHECK_GOOD}},
    {.told = {"calibration", "sensor-calibration", "sensor-calibration-code", CLI_CHECK_ODD,
              CLI_CHECK_GOOD}},
    {.judge = judge_service},
    {.told = {"clock", "clock-fault", "clock-fault-code", CLI_CHECK_BAD, CLI_CHECK_BAD}},
    {.told = {"time", "stale-fault", "stale-fault-code", CLI_CHECK_ODD, CLI_CHECK_ODD}},
    {.judge = judge_door},
    {.judge = judge_lines},
    {.judge = judge_priority},
    {.judge = judge_model},
    {.judge = judge_image_check},
    {.told = {"disk", "storage-fault", "storage-fault-code", CLI_CHECK_BAD, CLI_CHECK_BAD}},
    {.told = {"counter", "counter-fault", "counter-fault-code", CLI_CHECK_BAD, CLI_CHECK_BAD}},
    {.told = {"panel", "panel-fault", "panel-fault-code", CLI_CHECK_BAD, CLI_CHECK_BAD}},
    {.judge = judge_gallery},
    {.judge = judge_site},
};

void cli_diagnosis_judge(struct cli_diagnosis *diagnosis, const json_t *state)
{
    for (size_t i = 0; i < sizeof judgements / sizeof *judgements; i++) {
        if (judgements[i].judge) {
            judgements[i].judge(diagnosis, state);
        } else {
            judge_told(diagnosis, state, &judgements[i].told);
        }
    }
}

enum cli_exit cli_diagnosis_exit(const struct cli_diagnosis *diagnosis)
{
    enum cli_check worst = CLI_CHECK_GOOD;

    for (size_t i = 0; i < diagnosis->n_findings; i++) {
        const enum cli_check check = diagnosis->findings[i].check;
        worst = check > worst ? check : worst;
    }
    switch (worst) {
    case CLI_CHECK_BAD:
        return CLI_EXIT_FAULT;
    case CLI_CHECK_DENIED:
        return CLI_EXIT_NO;
    default:
        return CLI_EXIT_OK;
    }
}

void cli_diagnosis_print(const struct cli_diagnosis *diagnosis, FILE *out)
{
    static const enum iso_paint paints[] = {
        [CLI_CHECK_GOOD] = ISO_PAINT_GOOD,
        [CLI_CHECK_ODD] = ISO_PAINT_WARNING,
        [CLI_CHECK_DENIED] = ISO_PAINT_BAD,
        [CLI_CHECK_BAD] = ISO_PAINT_BAD,
    };
    const struct iso_terminal terminal = iso_terminal_of(out);

    for (size_t i = 0; i < diagnosis->n_findings; i++) {
        const struct cli_finding *finding = &diagnosis->findings[i];
        fprintf(out, "%s%-8s%s %-11s %s\n", iso_terminal_paint(&terminal, paints[finding->check]),
                check_names[finding->check], iso_terminal_paint(&terminal, ISO_PAINT_PLAIN),
                finding->subject, finding->found);
        if (cli_remedy(finding->code)) {
            fprintf(out, "%-8s %-11s -> %s\n", "", "", cli_remedy(finding->code));
        }
    }
}

json_t *cli_diagnosis_json(const struct cli_diagnosis *diagnosis)
{
    json_t *checks = json_array();

    for (size_t i = 0; i < diagnosis->n_findings; i++) {
        const struct cli_finding *finding = &diagnosis->findings[i];
        json_t *check = json_pack(
            "{s:s, s:s, s:s?, s:s, s:s?}", "subject", finding->subject, "state",
            check_names[finding->check], "code",
            finding->code == ISO_FAULT_NONE ? NULL : iso_fault_code_name(finding->code), "found",
            finding->found, "remedy", cli_remedy(finding->code));
        if (json_array_append_new(checks, check) < 0) {
            json_decref(checks);
            return NULL;
        }
    }
    return json_pack("{s:b, s:o}", "healthy", cli_diagnosis_exit(diagnosis) == CLI_EXIT_OK,
                     "checks", checks);
}
