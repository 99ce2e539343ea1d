#include "firmware/appliance/appliance.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <syslog.h>

#include "firmware/appliance/appliance_access.h"
#include "firmware/appliance/appliance_calls.h"
#include "firmware/appliance/appliance_claim.h"

const char *iso_appliance_mode_name(enum iso_appliance_mode mode)
{
    static const char *const names[ISO_APPLIANCE_MODES] = {
        "watch", "claimed", "enroll", "verify", "identify",
    };
    return (unsigned)mode < ISO_APPLIANCE_MODES ? names[mode] : NULL;
}

int iso_appliance_new(const struct iso_appliance_borrowed *borrowed, struct iso_appliance **out)
{
    struct iso_appliance *appliance = calloc(1, sizeof *appliance);
    if (!appliance) {
        return -ENOMEM;
    }
    appliance->borrowed = *borrowed;
    iso__appliance_init_claim(appliance);
    int error = iso__appliance_new_door(appliance);
    if (!error) {
        error = iso__appliance_new_repeats(appliance);
    }
    if (!error) {
        error = iso__appliance_new_access(appliance);
    }
    if (!error) {
        error = iso_audit_writer_new(borrowed->audit, &appliance->borrowed.times, borrowed->threads,
                                     &appliance->log);
    }
    if (error) {
        iso_appliance_free(appliance);
        return error;
    }
    *out = appliance;
    return 0;
}

void iso_appliance_free(struct iso_appliance *appliance)
{
    if (appliance) {
        iso__appliance_free_door(appliance); /* its thread posts records */
        iso_audit_writer_free(appliance->log);
        iso__appliance_close_sensor(appliance);
        iso__appliance_wipe_enrolment(appliance);
        iso__appliance_free_repeats(appliance);
        iso__appliance_free_fleet(appliance);
        iso__appliance_free_access(appliance);
        explicit_bzero(appliance, sizeof *appliance); /* the frame worked on last */
        free(appliance);
    }
}

/* Names nobody, because the system's log is not sealed. */
static void tell_unusable(struct iso_appliance *appliance)
{
    size_t n = 0, unusable = 0;
    const struct iso_person *people = iso_gallery_people(appliance->borrowed.gallery, &n);
    for (size_t i = 0; i < n; i++) {
        unusable += people[i].usable == 0;
    }
    if (unusable > 0) {
        iso__appliance_say(appliance, LOG_WARNING,
                           "%zu of %zu people have templates of another algorithm only and are "
                           "not recognised until they are enrolled anew",
                           unusable, n);
    }
}

/* Names nobody, either. */
static void tell_same_names(struct iso_appliance *appliance)
{
    const size_t n = iso_gallery_same_names(appliance->borrowed.gallery);
    if (n > 0) {
        iso__appliance_say(appliance, LOG_WARNING,
                           "names of enrolled people that look like another's: %zu; isotherm list "
                           "names them, give one of each pair another name (isotherm rename)",
                           n);
    }
}

static void tell_image_check(struct iso_appliance *appliance)
{
    const struct iso_pipeline *pipeline = &appliance->borrowed.pipeline;
    const char *word = iso_appliance_status(appliance).image_check;
    if (strcmp(word, "absent") == 0) {
        const char *lacks = pipeline->ops->image_lacks
                                ? pipeline->ops->image_lacks(pipeline->self)
                                : "something that the check needs is missing";
        iso__appliance_say(appliance, LOG_WARNING, "images are not checked for faces: %s", lacks);
    }
}

int iso_appliance_start(struct iso_appliance *appliance, struct iso_fault *fault)
{
    const int64_t now_ns = iso_times_now_ns(&appliance->borrowed.times);
    appliance->start_ns = now_ns;
    iso__appliance_init_storage(appliance);
    iso__appliance_init_face(appliance);
    iso__appliance_init_visit(appliance);
    iso_suspension_init(&appliance->suspension, &appliance->borrowed.times);
    int error = iso__appliance_start_door(appliance, fault); /* first: it does not need the disk */
    if (error) {
        return error;
    }
    iso__appliance_record_gallery(appliance, "start", ISOTHERM_VERSION);
    iso__appliance_load_settings(appliance);
    iso__appliance_record_door(appliance);
    iso__appliance_start_panel(appliance);
    iso__appliance_unlearn(appliance);
    error = iso__appliance_load_policy(appliance);
    if (error) {
        return iso_fault_set(fault, error, "policy: out of memory");
    }
    iso__appliance_start_fleet(appliance);
    tell_unusable(appliance);
    tell_same_names(appliance);
    iso__appliance_start_lockout(appliance);
    tell_image_check(appliance);
    error = iso__appliance_open_sensor(appliance, iso__appliance_now_ns(appliance), fault);
    iso__appliance_tell_door(appliance);
    return error;
}

/* The person before the camera may have changed during a suspension. */
static void follow_suspension(struct iso_appliance *appliance)
{
    if (iso_suspension_look(&appliance->suspension, &appliance->borrowed.times)) {
        iso__appliance_forget_face(appliance);
    }
}

/* By the clock of the steps. The door has another clock, which goes on during a suspension. */
static int64_t door_due_ns(const struct iso_appliance *appliance)
{
    const int64_t due_ns = iso_door_guard_due_ns(appliance->door);
    return due_ns == ISO_NEVER_NS ? due_ns : due_ns - appliance->suspension.asleep_ns;
}

/* When to step again at the latest. */
static int64_t next_step_ns(struct iso_appliance *appliance, int64_t now_ns)
{
    const int64_t due_ns[] = {
        door_due_ns(appliance),
        iso__appliance_door_events_due_ns(appliance),
        iso__appliance_sensor_due_ns(appliance, now_ns),
        iso__appliance_visit_due_ns(appliance),
        iso__appliance_lockout_due_ns(appliance),
        iso__appliance_storage_due_ns(appliance),
        iso__appliance_picture_due_ns(appliance),
        iso__appliance_action_due_ns(appliance),
        iso__appliance_access_due_ns(appliance),
        iso__appliance_panel_due_ns(appliance),
        iso__appliance_fleet_due_ns(appliance),
    };
    int64_t next_ns = ISO_NEVER_NS;
    for (size_t i = 0; i < sizeof due_ns / sizeof *due_ns; i++) {
        next_ns = due_ns[i] < next_ns ? due_ns[i] : next_ns;
    }
    return next_ns;
}

int64_t iso_appliance_step(struct iso_appliance *appliance)
{
    follow_suspension(appliance);
    int64_t now_ns = iso_times_now_ns(&appliance->borrowed.times);
    iso_door_guard_step(appliance->door);
    iso__appliance_tell_door(appliance);
    iso__appliance_tell_panel(appliance, now_ns);
    iso__appliance_follow_site(appliance);
    iso__appliance_look_at_sensor(appliance, now_ns);
    now_ns = iso_times_now_ns(&appliance->borrowed.times);
    iso__appliance_lockout_time(appliance, now_ns);
    iso__appliance_clock_time(appliance);
    iso__appliance_storage_time(appliance, now_ns);
    iso__appliance_counter_time(appliance, now_ns);
    iso__appliance_action_deadline(appliance, now_ns);
    iso__appliance_picture_time(appliance, now_ns);
    iso__appliance_access_time(appliance, now_ns);
    iso__appliance_read_cards(appliance);
    iso__appliance_fleet_time(appliance, now_ns);
    return next_step_ns(appliance, now_ns);
}

void iso_appliance_stop(struct iso_appliance *appliance)
{
    const struct iso_audit_record record = iso_audit_record_of("stop");
    iso_door_guard_stop(appliance->door);
    iso__appliance_tell_door(appliance);
    iso__appliance_flush_door(appliance);
    iso__appliance_close_sensor(appliance);
    iso__appliance_end_attack(appliance);
    (void)iso__appliance_note(appliance, &record);
}

int iso_appliance_panel_fd(const struct iso_appliance *appliance)
{
    return appliance->borrowed.panel ? iso_panel_fd(appliance->borrowed.panel) : -1;
}

int iso_appliance_door_fd(const struct iso_appliance *appliance)
{
    return iso_door_guard_fd(appliance->door);
}
