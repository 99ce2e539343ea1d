#include "enroll/web/daemon/enrolment_report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "firmware/contract/contract.h"

/* ---- signals ---- */

/* What goes on: a usable frame, a frame of another face, or a hint. */
static void take_progress(struct web_enrolment_report *report, const char *word, double quality)
{
    static const char retry[] = ISO_CONTRACT_RESULT_RETRY;
    if (strcmp(word, ISO_CONTRACT_RESULT_STAGE_PASSED) == 0) {
        report->hint[0] = '\0';
        if (report->n_captures < WEB_CAPTURES_MOST && isfinite(quality)) {
            report->captures[report->n_captures++] = quality;
        }
    } else if (strncmp(word, retry, sizeof retry - 1) == 0) {
        (void)snprintf(report->hint, sizeof report->hint, "%s", word + sizeof retry - 1);
    }
}

bool web__enrolment_read_status(struct web_enrolment_report *report, sd_bus_message *signal)
{
    static const char prefix[] = "enroll-";
    const char *word, *person;
    uint32_t stage, stages;
    double quality;
    int done;
    if (sd_bus_message_read(signal, "sbuuds", &word, &done, &stage, &stages, &quality, &person) <
            0 ||
        strncmp(word, prefix, sizeof prefix - 1) != 0) {
        return false;
    }
    word += sizeof prefix - 1;
    report->stage = stage;
    report->stages = stages;
    if (!done) {
        take_progress(report, word, quality);
        return false;
    }
    report->hint[0] = '\0';
    (void)snprintf(report->result, sizeof report->result, "%s", word);
    (void)snprintf(report->about, sizeof report->about, "%s", person);
    return true;
}

void web__enrolment_read_step(struct web_enrolment_report *report, sd_bus_message *signal)
{
    const char *pose, *state;
    uint32_t step, steps;
    double turn_deg;
    if (sd_bus_message_read(signal, "ssuud", &pose, &state, &step, &steps, &turn_deg) < 0 ||
        step < 1 || step > WEB_STEPS_MOST) {
        return;
    }
    struct web_enrolment_step *known = &report->steps[step - 1];
    report->n_steps = (int)step > report->n_steps ? (int)step : report->n_steps;
    (void)snprintf(known->pose, sizeof known->pose, "%s", pose);
    (void)snprintf(known->state, sizeof known->state, "%s", state);
    known->turn_deg = isfinite(turn_deg) ? turn_deg : 0.0;
    if (strcmp(state, ISO_CONTRACT_STEP_TURN) != 0) {
        report->hint[0] = '\0'; /* a hint of the step before says the wrong thing now */
    }
}

/* ---- JSON ---- */

static json_t *captures_json(const struct web_enrolment_report *report)
{
    json_t *captures = json_array();
    for (int i = 0; i < report->n_captures; i++) {
        (void)json_array_append_new(captures, json_real(report->captures[i]));
    }
    return captures;
}

static json_t *steps_json(const struct web_enrolment_report *report)
{
    json_t *steps = json_array();
    for (int i = 0; i < report->n_steps; i++) {
        const struct web_enrolment_step *s = &report->steps[i];
        if (s->pose[0]) {
            (void)json_array_append_new(steps,
                                        json_pack("{s:s, s:s, s:f}", "pose", s->pose, "state",
                                                  s->state, "turn_deg", s->turn_deg));
        }
    }
    return steps;
}

/* What only an enrolment has that has ended. */
static void add_result(const struct web_enrolment_report *report, json_t *object)
{
    (void)json_object_set_new(object, "result", json_string(report->result));
    if (strcmp(report->result, ISO_CONTRACT_RESULT_DUPLICATE) == 0) {
        (void)json_object_set_new(object, "known_as", json_string(report->about));
    } else if (strcmp(report->result, ISO_CONTRACT_RESULT_NOT_STORED) == 0) {
        (void)json_object_set_new(object, "detail", json_string(report->about));
    }
}

json_t *web__enrolment_report_json(const struct web_enrolment_report *report)
{
    static const char *const states[] = {"none", "running", "ended"};
    if (report->state == WEB_ENROLMENT_NONE) {
        return json_pack("{s:s}", "state", states[report->state]);
    }
    json_t *object = json_pack(
        "{s:s, s:s, s:s, s:b, s:s, s:I, s:I, s:o, s:o}", "state", states[report->state], "person",
        report->person, "account", report->account, "poses", (int)report->poses, "hint",
        report->hint, "stage", (json_int_t)report->stage, "stages", (json_int_t)report->stages,
        "captures", captures_json(report), "steps", steps_json(report));
    if (report->state == WEB_ENROLMENT_ENDED) {
        add_result(report, object);
    }
    return object;
}
