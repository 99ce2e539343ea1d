#include "tests/fleet/check_update.h"

#include <limits.h>
#include <stdio.h>

#include "firmware/fleet/update/update.h"

/* Under the folder of the door, as they are in an image (firmware/fleet/program/service.c). */
#define UPDATES "image/var/lib/isotherm-update"
#define PROGRAM "image/bin/isotherm"

static void on_ordered(void *context, const struct iso_fleet_update *order)
{
    link_update_ordered(context, order);
}

static void on_answered(void *context)
{
    link_update_answered(context);
}

int check_update_start(const char *folder, struct link_setup *link, struct link_update **out,
                       struct iso_fault *fault)
{
    char updates[PATH_MAX], program[PATH_MAX];
    (void)snprintf(updates, sizeof updates, "%s/" UPDATES, folder);
    (void)snprintf(program, sizeof program, "%s/" PROGRAM, folder);
    const struct link_update_setup setup = {.event = link->event,
                                            .daemon = link->daemon,
                                            .http = link->http,
                                            .hub_url = link->hub_url,
                                            .ca_file = link->broker.ca_file,
                                            .folder = folder,
                                            .updates = updates,
                                            .program = program,
                                            .retry_ms = 500,
                                            .note_context = link->note_context,
                                            .note = link->note};
    const int error = link_update_new(&setup, out, fault);
    if (!error) {
        link->update_context = *out;
        link->ordered = on_ordered;
        link->answered = on_answered;
    }
    return error;
}

void check_update_describe(const struct link_update *update, char *answer, size_t size)
{
    const struct iso_fleet_update_report *report = link_update_report(update);
    (void)snprintf(answer, size, "%s %s %s",
                   report->is_known ? iso_fleet_update_state_word(report->state) : "unknown",
                   report->version[0] ? report->version : "-", report->fault);
}
