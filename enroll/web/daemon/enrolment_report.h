/* What became of an enrolment so far, as the daemon reports it. Internal to enroll/web/daemon. */
#ifndef WEB_DAEMON_ENROLMENT_REPORT_H
#define WEB_DAEMON_ENROLMENT_REPORT_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <systemd/sd-bus.h>

#include "enroll/web/account/account.h"
#include "firmware/contract/person_name.h"

enum { WEB_CAPTURES_MOST = 128, WEB_STEPS_MOST = 8, WEB_WORD_SIZE = 32 };

enum web_enrolment_state { WEB_ENROLMENT_NONE, WEB_ENROLMENT_RUNNING, WEB_ENROLMENT_ENDED };

struct web_enrolment_report {
    enum web_enrolment_state state;
    char person[ISO_PERSON_NAME_SIZE], account[WEB_ACCOUNT_NAME_SIZE];
    bool poses;
    char result[WEB_WORD_SIZE], hint[WEB_WORD_SIZE];
    char about[ISO_PERSON_NAME_SIZE]; /* a duplicate's name, or the error of the disk */
    unsigned stage, stages;
    int n_captures, n_steps;
    double captures[WEB_CAPTURES_MOST];
    struct web_enrolment_step {
        char pose[WEB_WORD_SIZE], state[WEB_WORD_SIZE];
        double turn_deg;
    } steps[WEB_STEPS_MOST];
};

/* Reads EnrollStatus. Returns whether it is the last one; then `result` is set. A signal that
 * cannot be read changes nothing. */
bool web__enrolment_read_status(struct web_enrolment_report *report, sd_bus_message *signal);

/* Reads EnrollStep. */
void web__enrolment_read_step(struct web_enrolment_report *report, sd_bus_message *signal);

/* The object Enrolment of openapi.json, without `own`. NULL: there is no memory. */
json_t *web__enrolment_report_json(const struct web_enrolment_report *report);

#endif
