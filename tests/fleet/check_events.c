#include "tests/fleet/check_events.h"

#include <stdio.h>
#include <stdlib.h>

static void on_visit(void *context, const struct iso_visit *visit)
{
    struct check_heard *heard = context;
    (void)snprintf(heard->visit, sizeof heard->visit, "%s %s",
                   visit->verdict.allow ? "allow" : "deny",
                   visit->verdict.allow ? visit->person : iso_reason_name(visit->verdict.reason));
}

static void on_enroll_status(void *context, const char *result, bool done, unsigned stage,
                             unsigned stages, double quality, const char *person)
{
    (void)context, (void)result, (void)done, (void)stage, (void)stages, (void)quality, (void)person;
}

static void on_enroll_step(void *context, const char *pose, const char *state, unsigned step,
                           unsigned steps, double turn_deg)
{
    (void)context, (void)pose, (void)state, (void)step, (void)steps, (void)turn_deg;
}

static void on_recognition(void *context, enum iso_appliance_mode mode, const char *result,
                           bool done, const char *person, double score, double threshold)
{
    (void)context, (void)mode, (void)result, (void)done, (void)person, (void)score;
    (void)threshold;
}

static void on_wanted(void *context, const char *what)
{
    (void)context, (void)what;
}

static void on_hint(void *context, enum iso_capture capture)
{
    (void)context, (void)capture;
}

static void on_view(void *context, const struct iso_view *view)
{
    (void)context, (void)view;
}

static void on_picture(void *context, const struct iso_frame *frame)
{
    (void)context, (void)frame;
}

static void on_door_changed(void *context, const char *state, const char *cause)
{
    (void)context, (void)state, (void)cause;
}

static void on_claim_lost(void *context)
{
    (void)context;
}

static void on_fleet_work(void *context, const char *what)
{
    const struct check_heard *heard = context;
    if (heard->link) {
        link_door_work(heard->link, what);
    }
}

static void on_message(void *context, int priority, const char *text)
{
    const struct check_heard *heard = context;
    if (priority <= 4 && getenv("FLEET_DOORS_LOUD")) {
        fprintf(stderr, "%s: %s\n", heard->folder, text);
    }
}

struct iso_appliance_events check_events(struct check_heard *heard)
{
    return (struct iso_appliance_events){
        .enroll_status = on_enroll_status,
        .enroll_step = on_enroll_step,
        .recognition_status = on_recognition,
        .visit = on_visit,
        .wanted = on_wanted,
        .hint = on_hint,
        .view = on_view,
        .picture = on_picture,
        .door_changed = on_door_changed,
        .claim_lost = on_claim_lost,
        .fleet_work = on_fleet_work,
        .message = on_message,
        .context = heard,
    };
}
